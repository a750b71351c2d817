"""Commands to bytes (src/link/PROTOCOL.md)."""

from __future__ import annotations

import struct

from ..errors import TelemetryError
from .codes import CommandKind
from .frames import VERSION, framed

__all__ = ["air", "encode", "indentation", "object_", "rate", "save", "self_test"]

#: Bytes that go with a command; a load's are longer or vary.
_PAYLOADS = {
    CommandKind.TARE: 0,
    CommandKind.UNDO: 0,
    CommandKind.SAVE: 4,
    CommandKind.INFO: 0,
    CommandKind.SELF_TEST: 4,
    CommandKind.RATE: 2,
    CommandKind.FORGET: 0,
    CommandKind.OBJECT: 5,
    CommandKind.INDENTATION: 4,
    CommandKind.AIR: 4,
}
#: Gain that keeps the one there is.
KEEP_GAIN = -(2**31)
#: Shapes by name.
_SHAPES = {"plate": 0, "ball": 1, "cup": 2, "cylinder": 3}


def encode(kind: CommandKind, sequence: int, payload: bytes = b"") -> bytes:
    """The frame of a command.

    Raises:
        TelemetryError: what the board would not take for a command, on one line.
    """
    if not 0 <= sequence <= 0xFFFF:
        raise TelemetryError(f"`{sequence}` is no sequence number from 0 to 65535")
    needed = _PAYLOADS.get(kind, len(payload))
    if len(payload) != needed:
        raise TelemetryError(f"with {kind.word} go {needed} bytes, not {len(payload)}")
    number = int.from_bytes(payload, "little", signed=True)
    if kind == CommandKind.RATE and not 1 <= number <= 1000:
        raise TelemetryError("a rate is 1 to 1000")
    if kind == CommandKind.SAVE and number != KEEP_GAIN and abs(number) > 100_000:
        raise TelemetryError("a gain is -100000 to 100000 parts in a million, or 00000080 to keep the one there is")
    if kind == CommandKind.SELF_TEST and number < 0:
        raise TelemetryError("an indentation is 0 nm or more")
    return framed(struct.pack("<BBH", VERSION, kind, sequence) + payload)


def _scaled(name: str, value: float, factor: float, low: int, high: int) -> bytes:
    try:
        number = round(value * factor)
    except (TypeError, ValueError, OverflowError):
        number = None
    if number is None or not low <= number <= high:
        raise TelemetryError(f"{name} is {value}: must be {low / factor:g} to {high / factor:g}")
    return struct.pack("<i", number)


def save(gain_ppm: int | None) -> bytes:
    """With ``save``: gain added to the pressure rise, parts in a million; ``None`` keeps the one there is."""
    return struct.pack("<i", KEEP_GAIN) if gain_ppm is None else _scaled("gain_ppm", gain_ppm, 1, -100_000, 100_000)


def self_test(indentation_mm: float) -> bytes:
    """With ``self-test``: the indentation that a stop holds, mm; 0 is not known."""
    return _scaled("indentation_mm", indentation_mm, 1e6, 0, 2**31 - 1)


def rate(every: int) -> bytes:
    """With ``rate``: every so many-th report goes on the line."""
    return _scaled("every", every, 1, 1, 1000)[:2]


def object_(shape: str, radius_mm: float) -> bytes:
    """With ``object``: what is touched, and its radius, mm; 0 of a plate."""
    if shape not in _SHAPES:
        raise TelemetryError(f"shape is {shape!r}: must be of {', '.join(_SHAPES)}")
    least = 0 if shape == "plate" else 1
    most = 0 if shape == "plate" else 2**31 - 1
    return bytes([_SHAPES[shape]]) + _scaled("radius_mm", radius_mm, 1e3, least, most)


def indentation(indentation_mm: float) -> bytes:
    """With ``indentation``: how deep the tip is pressed now, mm."""
    return _scaled("indentation_mm", indentation_mm, 1e6, 1, 2**31 - 1)


def air(pressure_pa: float) -> bytes:
    """With ``air``: pressure of the air around an absolute part, Pa."""
    return _scaled("pressure_pa", pressure_pa, 1, 60_000, 108_000)
