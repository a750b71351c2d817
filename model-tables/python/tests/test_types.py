"""The package's types: checked as mypy checks them strictly, beside the compiled module, and as a program that uses the package sees them."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import fingertip

HERE = Path(__file__).resolve().parents[1]
#: A program of a user: every line of it is right but those that name an error.
PROGRAM = """
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

import fingertip
from fingertip.telemetry import AsyncClient, Batch, Client, Fault, Reading


def stiffness(design: fingertip.DesignLike, depths: Sequence[float]) -> NDArray[np.float64]:
    states = fingertip.solve(design, depths)
    return np.gradient(states.force_n, states.indentation_mm)


def readings(address: str) -> Batch:
    with Client(address) as board:
        for frame in board:
            if isinstance(frame, Reading):
                print(frame.tip + 1, 1e3 * frame.force_n)
        return board.batch(seconds=1.0)


async def force(address: str) -> float | None:
    async with AsyncClient(address) as board:
        async for frame in board:
            if isinstance(frame, Reading):
                return frame.force_n
    return None


best: fingertip.SizedDesign = fingertip.size("target.toml").designs[0]
name: str = best.design.name + best.model
fit: fingertip.Fit = fingertip.fit("a.toml", {"force_n": [1.0], "indentation_mm": [0.1]}, parameters=["material"])
value: float = fit["material"].value
"""
#: Each is refused.
WRONG = {
    'fingertip.solve("a.toml", 1.0).force_kn': "attr-defined",
    'fingertip.solve("a.toml", force_n=1.0)': "call-arg",
    'length: int = fingertip.rest("a.toml").ends_by': "assignment",
    'fingertip.estimate("a.toml", [1.0]).saturated = None': "misc",
    'fingertip.history("a.toml", [0.0], [0.0])': "misc",
}


def run(*arguments, folder):
    pytest.importorskip("mypy")
    environment = {**os.environ, "MYPYPATH": "", "MYPY_CACHE_DIR": os.environ.get("MYPY_CACHE_DIR", str(folder / "cache"))}
    return subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def test_the_package_has_every_type_strictly(tmp_path):
    """Of the source, with the settings of pyproject.toml."""
    checked = run("-m", "mypy", "--config-file", HERE / "pyproject.toml", HERE / "package" / "fingertip", folder=tmp_path)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert "no issues found in" in checked.stdout


def test_the_stub_of_the_compiled_module_is_the_module(tmp_path):
    """Names, arguments, their order and defaults, of the installed wheel."""
    checked = run("-m", "mypy.stubtest", "fingertip._fingertip", folder=tmp_path)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_a_users_program_sees_the_types(tmp_path):
    """The installed wheel says that it has types, and a slip in a name, an argument or a unit's type is found."""
    (tmp_path / "program.py").write_text(PROGRAM, encoding="utf-8")
    checked = run("-m", "mypy", "--strict", "program.py", folder=tmp_path)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    lines = list(WRONG)
    (tmp_path / "wrong.py").write_text("import fingertip\n" + "\n".join(lines) + "\n", encoding="utf-8")
    checked = run("-m", "mypy", "--strict", "wrong.py", folder=tmp_path)
    for number, line in enumerate(lines, 2):
        found = [text for text in checked.stdout.splitlines() if text.startswith(f"wrong.py:{number}: error")]
        assert any(f"[{WRONG[line]}]" in text for text in found), f"{line}\n{checked.stdout}"
    assert (Path(fingertip.__file__).parent / "py.typed").is_file()
