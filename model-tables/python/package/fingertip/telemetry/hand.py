"""A board of several tips (src/link/PROTOCOL.md, version 3): its frames, and a client whose commands name a tip."""

from __future__ import annotations

import struct
from dataclasses import dataclass, replace

from ..errors import TelemetryError
from . import commands
from .client import CAPACITY, Client
from .codes import CommandKind, Fault, Outcome, Stored, Touch, Warnings
from .frames import Answer, FaultReport, Frame, FrameError, Hello, Reading, body_of, decode, framed

__all__ = ["ALL_TIPS", "HAND_BAUD", "HandClient", "TipHello", "decode_hand", "encode"]

#: Version of the protocol that a hand has.
VERSION = 3
#: Speed of a hand's serial port, bits a second.
HAND_BAUD = 1_000_000
#: The tip of a command that all tips are to take.
ALL_TIPS = 255
#: Most tips of a hand.
MAX_TIPS = 12
#: Bytes of the longest frame without its zero.
LONGEST = 243

_TIP = struct.Struct("<BH3i3B")
_TIP_HELLO = struct.Struct("<BQIIBIIB")


@dataclass(frozen=True, slots=True)
class TipHello(Frame):
    """What a tip of a hand is, once a second."""

    #: Hash of its design.
    design_hash: int
    #: Version of its tables.
    table_version: int
    #: From one of its reports on the line to the next, us.
    period_us: int
    stored: Stored
    #: Number of the record that changed its stored calibration last; 0: none did.
    saves: int
    #: Samples that its filter replaced since reset.
    samples_replaced: int
    #: Its name.
    name: str


def decode_hand(body: bytes) -> list[Frame]:
    """The frames of a body: of readings one a tip, all of one time; of others one. The board's own hello has the tip 0.

    Raises:
        FrameError: a version, kind, length or code that no hand sends.
    """
    if len(body) < 15 or body[0] != VERSION:
        raise FrameError("version, kind or length")
    _, kind, sequence, time, dropped = struct.unpack_from("<BBHQH", body)
    try:
        if kind == 5:
            return _readings(body, sequence, time, dropped)
        if kind == 6:
            return [_tip_hello(body, sequence, time, dropped)]
    except FrameError:
        raise
    except ValueError:
        raise FrameError("field") from None
    # The others are those of version 2 and a tip, or how many.
    if kind == 3 and len(body) == 62:
        hello = decode(bytes([2]) + body[1:61])
        if not isinstance(hello, Hello) or not 1 <= body[61] <= MAX_TIPS:
            raise FrameError("field")
        return [replace(hello, tips=body[61])]
    if kind in (4, 7, 8) and len(body) > 15:
        own = decode(bytes([2]) + body[1:14] + body[15:])
        if body[14] >= MAX_TIPS:
            raise FrameError("field")
        return [replace(own, tip=body[14])]
    raise FrameError("version, kind or length")


def _readings(body: bytes, sequence: int, time: int, dropped: int) -> list[Frame]:
    tips, k = body[14], body[15] if len(body) > 15 else 32
    if not 1 <= tips <= MAX_TIPS or k > 31:
        raise ValueError
    if len(body) != 16 + _TIP.size * tips:
        raise FrameError("version, kind or length")
    count = 2.0**-k
    frames: list[Frame] = []
    for tip in range(tips):
        first, word, rise, force, indentation, *sigmas = _TIP.unpack_from(body, 16 + _TIP.size * tip)
        header = (sequence, time, dropped, tip)
        if first & 0x4F != tip:
            raise ValueError
        if first & 0x80:
            if first & 0x30 or word > 0xFF or any((rise, force, indentation, *sigmas)):
                raise ValueError
            frames.append(FaultReport(*header, Fault(word)))
            continue
        # 255: that or more.
        deviations = [float("inf") if sigma == 255 else 2.0 ** (sigma / 8) for sigma in sigmas]
        values = (rise * count, 1e-6 * force, 1e-6 * indentation)
        frames.append(
            Reading(
                *header, Warnings(word), Touch(first >> 4 & 3), *values,
                deviations[0] * count, 1e-6 * deviations[1], 1e-6 * deviations[2],
            )
        )  # fmt: skip
    return frames


def _tip_hello(body: bytes, sequence: int, time: int, dropped: int) -> TipHello:
    if len(body) < 41 or len(body) != 41 + body[40]:
        raise FrameError("version, kind or length")
    tip, design, tables, period, stored, saves, replaced, _ = _TIP_HELLO.unpack_from(body, 14)
    if tip >= MAX_TIPS or body[40] > 32:
        raise ValueError
    return TipHello(sequence, time, dropped, tip, design, tables, period, Stored(stored), saves, replaced, body[41:].decode())


def encode(tip: int, kind: CommandKind, sequence: int, payload: bytes = b"") -> bytes:
    """The frame of a command to a tip, or to :data:`ALL_TIPS`.

    Raises:
        TelemetryError: what the board would not take for a command, on one line.
    """
    if not (0 <= tip < MAX_TIPS or tip == ALL_TIPS):
        raise TelemetryError(f"`{tip}` is no tip from 0 to {MAX_TIPS - 1}, nor {ALL_TIPS} for all")
    plain = body_of(commands.encode(kind, sequence, payload)[:-1])
    # Of version 2 `load begin` alone has a tip, in that place.
    own = plain[5:] if kind == CommandKind.BEGIN else plain[4:]
    return framed(bytes([VERSION]) + plain[1:4] + bytes([tip]) + own)


class HandClient(Client):
    """A hand behind a serial port or socket, or a file of its bytes. Iterating gives a :class:`Reading` or
    :class:`FaultReport` of each tip, those of one instant one after the other with one time.

    Commands go to :attr:`tip`: a number, or :data:`ALL_TIPS`; each tip that is asked answers for itself. Arguments and errors are
    those of :class:`Client`.
    """

    #: The tip that commands go to.
    tip: int

    _longest = LONGEST

    def __init__(
        self,
        address: str,
        *,
        tip: int = 0,
        baud: int = HAND_BAUD,
        capacity: int = CAPACITY,
        reconnect: bool = True,
        poll: float | None = None,
    ) -> None:
        self.tip = tip
        super().__init__(address, baud=baud, capacity=capacity, reconnect=reconnect, poll=poll)

    def _decode(self, body: bytes) -> list[Frame]:
        return decode_hand(body)

    def _encode(self, kind: CommandKind, sequence: int, payload: bytes) -> bytes:
        return encode(self.tip, kind, sequence, payload)

    def _is_asked(self, frame: Frame) -> bool:
        return self.tip in (frame.tip, ALL_TIPS)

    def hello(self) -> Hello:
        """Asks the board what it is; its stored calibration is that of the first tip."""
        before, self.tip = self.tip, 0
        try:
            return super().hello()
        finally:
            self.tip = before

    def names(self) -> list[str]:
        """Asks for the names of the tips, in their order.

        Raises:
            TelemetryError: the board did not answer.
        """
        found: dict[int, str] = {}
        tips = 0

        def wanted(frame: Frame, _: int) -> bool:
            nonlocal tips
            if isinstance(frame, Hello):
                tips = frame.tips
            if isinstance(frame, TipHello):
                found[frame.tip] = frame.name
            return 0 < tips == len(found)

        before, self.tip = self.tip, ALL_TIPS
        try:
            with self._commanding:
                last = self.ask(CommandKind.INFO, b"", wanted, 2.0)
        finally:
            self.tip = before
        if last is None:
            raise TelemetryError(f"{self.address.text}: no hand answers; see that it is a hand's port, at {HAND_BAUD} baud")
        return [found[tip] for tip in sorted(found)]

    def command_all(self, kind: CommandKind, payload: bytes = b"", *, timeout: float = 6.0) -> dict[int, Outcome]:
        """Sends a command to all tips; what came of it, by tip. Fewer tips than the hand has: those did not answer in that time, s.

        Raises:
            TelemetryError: the board did not answer.
        """
        tips = len(self.names())
        outcomes: dict[int, Outcome] = {}

        def wanted(frame: Frame, sequence: int) -> bool:
            if isinstance(frame, Answer) and (frame.command, frame.command_sequence) == (kind, sequence):
                outcomes[frame.tip] = frame.outcome
            return len(outcomes) == tips

        before, self.tip = self.tip, ALL_TIPS
        try:
            with self._commanding:
                self.ask(kind, payload, wanted, timeout)
        finally:
            self.tip = before
        return outcomes
