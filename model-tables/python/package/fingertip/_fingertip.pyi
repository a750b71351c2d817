"""The compiled part; :mod:`fingertip` puts names and units to it. Numbers come as native 64-bit floats, column after column."""

from typing import final

__all__ = [
    "SweepFolder",
    "canonical",
    "estimate",
    "fit",
    "history",
    "rest",
    "size",
    "solve",
    "sweep",
    "sweep_part",
    "sweep_text",
    "table",
]

def canonical(text: str, name: str) -> str: ...
def rest(text: str, name: str) -> tuple[str, list[float], str]: ...
def solve(text: str, name: str, indentation_mm: list[float]) -> tuple[str, bytes, list[str]]: ...
def history(
    text: str, name: str, time_s: list[float], driven: list[float], by_force: bool
) -> tuple[bytes, list[bool]]: ...
def table(
    text: str, name: str, allow_worse: bool
) -> tuple[bytes, str, str, str, int, int, list[float]]: ...
def estimate(
    text: str, name: str, pressure_rise_pa: list[float], allow_worse: bool
) -> tuple[bytes, list[bool]]: ...
def fit(
    text: str,
    name: str,
    data: bytes,
    data_name: str,
    parameters: list[str],
    per_trial: list[str],
    columns: list[tuple[str, str]],
    only: list[tuple[str, str]],
    direction: str | None,
) -> tuple[
    str,
    list[tuple[str, str, float, float, float, str]],
    list[tuple[str, str, float, float]],
    bytes,
    tuple[bytes, list[bool], list[bool], list[str]],
    list[float],
    list[float],
    list[str],
]: ...
def size(
    text: str, name: str, best: int
) -> tuple[list[tuple[str, str, str, bool, str, list[float], bytes]], list[str], int, list[float]]: ...
def sweep_text(path: str) -> str: ...
def sweep(path: str, out: str) -> tuple[int, int, int, int, str | None, int]: ...
def sweep_part(text: str, part: int, manifest: str) -> tuple[bytes, int, int, str | None]: ...
@final
class SweepFolder:
    text: str
    def __new__(cls, path: str, out: str) -> SweepFolder: ...
    @property
    def manifest(self) -> str: ...
    @property
    def size(self) -> tuple[int, int, int]: ...
    def left(self) -> list[int]: ...
    def write(self, part: int, content: bytes) -> None: ...
