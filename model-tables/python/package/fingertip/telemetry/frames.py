"""Bytes of the line to frames: COBS, CRC, and the fields of each kind (src/link/PROTOCOL.md). The standard library alone."""

from __future__ import annotations

import binascii
import struct
from collections.abc import Iterator
from dataclasses import dataclass

from .codes import CommandKind, Fault, LastRun, Outcome, ResetCause, Stored, Touch, Warnings

__all__ = ["Answer", "Band", "BandRow", "FaultReport", "Frame", "FrameError", "Hello", "Reading", "Splitter", "TipData", "body_of", "decode", "framed"]

#: Version of the protocol that the commands have.
VERSION = 2
#: Bytes of the longest frame without its zero: more of them in a row are no frame.
LONGEST = 83


class FrameError(ValueError):
    """Bytes that are no frame: what is wrong with them, in a word."""


@dataclass(frozen=True, slots=True)
class Frame:
    """What every frame has."""

    #: One counter over all kinds, which wraps from 65535 to 0.
    sequence: int
    #: Time since the board's reset, us; of a reading or fault the middle of its samples.
    time_us: int
    #: Frames that the board dropped since its reset because the line was not free; wraps at 65536.
    dropped: int
    #: Number of the tip; 0 from a board that carries one.
    tip: int


@dataclass(frozen=True, slots=True)
class Reading(Frame):
    """A reading of one tip, with one standard deviation of each value."""

    #: What qualifies it.
    warnings: Warnings
    #: Whether something touches.
    touch: Touch
    #: Pressure over that at rest, Pa.
    pressure_rise_pa: float
    #: Force, N.
    force_n: float
    #: Indentation, mm.
    indentation_mm: float
    #: Standard deviation of the pressure rise, Pa.
    pressure_rise_sigma_pa: float
    #: Standard deviation of the force, N.
    force_sigma_n: float
    #: Standard deviation of the indentation, mm.
    indentation_sigma_mm: float
    #: Force of the feedback actuator, N; None of a design without one.
    feedback_force_n: float | None = None
    #: Its standard deviation, N.
    feedback_force_sigma_n: float | None = None

    @property
    def is_ok(self) -> bool:
        """Whether no warning qualifies it."""
        return not self.warnings


@dataclass(frozen=True, slots=True)
class FaultReport(Frame):
    """No reading, and why: what was read last tells nothing about now."""

    reason: Fault


@dataclass(frozen=True, slots=True)
class Hello(Frame):
    """What a board is, once a second."""

    #: Version of the firmware: major, minor, patch.
    firmware: tuple[int, int, int]
    reset_cause: ResetCause
    #: Hash of the design in use.
    design_hash: int
    #: Version of its tables.
    table_version: int
    #: From one report on the line to the next, us.
    period_us: int
    stored: Stored
    last_run: LastRun
    #: Resets in a row that nobody asked for.
    resets: int
    #: Task, line or address that belongs to ``last_run``.
    where: int
    #: Number of the stored calibration; 0: none.
    saves: int
    #: Samples lost since reset.
    samples_lost: int
    #: Samples that the filter replaced since reset.
    samples_replaced: int
    #: Frames dropped since reset.
    frames_dropped: int
    #: What came over the line since reset and was no command.
    refused: int
    #: Tips of a hand; 0 of a board that carries one.
    tips: int = 0


@dataclass(frozen=True, slots=True)
class Answer(Frame):
    """What came of a command."""

    command: CommandKind
    #: The sequence number that the command was sent with.
    command_sequence: int
    outcome: Outcome
    #: One bit each, by the command.
    findings: int
    #: Of a known indentation: force without any curvature, N; else nan.
    force_n: float = float("nan")
    #: Its standard deviation, N.
    force_sigma_n: float = float("nan")
    #: Curvature of what is touched, 1/m; 0 is flat.
    curvature_per_m: float = float("nan")
    #: Its standard deviation, 1/m.
    curvature_sigma_per_m: float = float("nan")


@dataclass(frozen=True, slots=True)
class TipData(Frame):
    """A part of the tip in use."""

    command_sequence: int
    #: Of the first byte in the block.
    offset: int
    content: bytes


@dataclass(frozen=True, slots=True)
class BandRow:
    """A part of a band: the truth less the reading, over the reading; lower and upper."""

    #: The last pressure rise of the row, Pa.
    to_pa: float
    #: Of the force, over the force that is read.
    force: tuple[float, float]
    #: Of the indentation, over that which is read.
    indentation: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Band(Frame):
    """Where the truth lies, from a tip that is not told what it touches. It belongs to the hello before it: the next hello, or an
    answer that an ``object`` is done, ends it."""

    #: The first pressure rise of which it tells, Pa.
    from_pa: float
    #: Rising, one beside the other.
    rows: tuple[BandRow, ...]

    def of(self, reading: Reading) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """Lower and upper force, N, and indentation, mm, of a reading, without its standard deviations; ``None`` where the band tells
        nothing: outside of its pressures, and of a reading that is a bound."""
        bounds = Warnings.SATURATED | Warnings.BELOW_ZERO | Warnings.RECOVERING
        if reading.warnings & bounds or reading.pressure_rise_pa < self.from_pa:
            return None
        for row in self.rows:
            if reading.pressure_rise_pa <= row.to_pa:
                lower, upper = row.force
                least, most = row.indentation
                force, indentation = reading.force_n, reading.indentation_mm
                return (force * (1 + lower), force * (1 + upper)), (indentation * (1 + least), indentation * (1 + most))
        return None


def stuffed(plain: bytes) -> bytes:
    """COBS, for fewer than 254 bytes."""
    return b"".join(bytes([len(part) + 1]) + part for part in plain.split(b"\0"))


def unstuffed(coded: bytes) -> bytes:
    """The bytes before COBS."""
    plain = bytearray()
    at, end = 0, len(coded)
    while at < end:
        code = coded[at]
        if code == 0 or at + code > end:
            raise FrameError("stuffing")
        plain += coded[at + 1 : at + code]
        plain.append(0)
        at += code
    return bytes(plain[:-1])


def framed(body: bytes) -> bytes:
    """A body as it goes on the line."""
    return stuffed(body + struct.pack("<H", binascii.crc_hqx(body, 0xFFFF))) + b"\0"


def body_of(coded: bytes) -> bytes:
    """The body of a frame without its zero.

    Raises:
        FrameError: it is no frame.
    """
    plain = unstuffed(coded)
    if len(plain) < 2 or binascii.crc_hqx(plain[:-2], 0xFFFF) != plain[-2] | plain[-1] << 8:
        raise FrameError("CRC")
    return plain[:-2]


_HEADER = struct.Struct("<BBHQH")
_READING = struct.Struct("<HBB6i")
_HELLO = struct.Struct("<3BBQIIBBB6I")
_ANSWER = struct.Struct("<BHBH")
_LENGTHS = {1: (42, 50), 2: (15,), 3: (61,), 4: (20, 36), 7: range(21, 77), 8: range(32, 81, 12)}


def decode(body: bytes) -> Frame:
    """The frame of a body.

    Raises:
        FrameError: a version, kind, length or code that this page does not have: none of it is a number.
    """
    if len(body) < _HEADER.size:
        raise FrameError("version, kind or length")
    version, kind, *header = _HEADER.unpack_from(body)
    if version != VERSION or len(body) not in _LENGTHS.get(kind, ()):
        raise FrameError("version, kind or length")
    # One tip a board: it has the number 0.
    sequence, time, dropped = header
    try:
        return _FIELDS[kind](body, (sequence, time, dropped, 0))
    except (ValueError, KeyError):
        raise FrameError("field") from None


_Header = tuple[int, int, int, int]


def _reading(body: bytes, header: _Header) -> Reading:
    bits, k, touch, rise, force, indentation, *sigmas = _READING.unpack_from(body, 14)
    if k > 31 or min(sigmas) < 0:
        raise ValueError
    count = 2.0**-k
    values: tuple[float, ...] = (rise * count, 1e-6 * force, 1e-6 * indentation, sigmas[0] * count, 1e-6 * sigmas[1], 1e-6 * sigmas[2])
    if len(body) == 50:
        feedback = struct.unpack_from("<2i", body, 42)
        if min(feedback) < 0:
            raise ValueError
        values += (1e-6 * feedback[0], 1e-6 * feedback[1])
    return Reading(*header, Warnings(bits), Touch(touch), *values)


def _fault(body: bytes, header: _Header) -> FaultReport:
    return FaultReport(*header, Fault(body[14]))


def _hello(body: bytes, header: _Header) -> Hello:
    fields = _HELLO.unpack_from(body, 14)
    major, minor, patch, cause, design, tables, period, stored, last, resets, where, saves, *counts = fields
    return Hello(
        *header, (major, minor, patch), ResetCause(cause), design, tables, period, Stored(stored), LastRun(last), resets,
        where, saves, *counts
    )  # fmt: skip


def _answer(body: bytes, header: _Header) -> Answer:
    command, sequence, outcome, findings = _ANSWER.unpack_from(body, 14)
    answer = (CommandKind(command), sequence, Outcome(outcome), findings)
    if len(body) == 20:
        return Answer(*header, *answer)
    if command != CommandKind.INDENTATION:
        raise ValueError
    force, force_sigma, curvature, curvature_sigma = struct.unpack_from("<4i", body, 20)
    return Answer(*header, *answer, 1e-6 * force, 1e-6 * force_sigma, 1e-3 * curvature, 1e-3 * curvature_sigma)


def _tip_data(body: bytes, header: _Header) -> TipData:
    sequence, offset = struct.unpack_from("<HI", body, 14)
    return TipData(*header, sequence, offset, body[20:])


def _band(body: bytes, header: _Header) -> Band:
    k, count, first = struct.unpack_from("<BBi", body, 14)
    if k > 31 or len(body) != 20 + 12 * count or first < 0:
        raise ValueError
    rows = []
    last = first
    for to, *ends in struct.iter_unpack("<i4h", body[20:]):
        if to <= last or ends[0] > ends[1] or ends[2] > ends[3]:
            raise ValueError
        last = to
        low, high, least, most = (1e-3 * end for end in ends)
        rows.append(BandRow(to * 2.0**-k, (low, high), (least, most)))
    return Band(*header, first * 2.0**-k, tuple(rows))


_FIELDS = {1: _reading, 2: _fault, 3: _hello, 4: _answer, 7: _tip_data, 8: _band}


class Splitter:
    """Bytes as they come to frames without their zeros; a stretch that has no zero is cut off.

    Args:
        longest: bytes of the longest frame without its zero.
    """

    def __init__(self, longest: int = LONGEST) -> None:
        self._waiting = b""
        self._longest = longest

    def feed(self, read: bytes) -> Iterator[bytes]:
        """The frames that end in these bytes."""
        *ended, self._waiting = (self._waiting + read).split(b"\0")
        # Of a stretch without a zero the first bytes are enough to be no frame.
        self._waiting = self._waiting[: self._longest + 1]
        return filter(None, ended)
