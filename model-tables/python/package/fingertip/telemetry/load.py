"""A tip's data onto a board, back to what was before, or read back (src/link/PROTOCOL.md, "Loading a tip").

Every command is repeated until it is answered: a line may lose, double or break frames, the connection may be lost for half a minute, and
the board may be reset at any time.
"""

from __future__ import annotations

import os
import struct
import time
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..errors import TelemetryError
from .client import RESET, Client
from .codes import CommandKind, Outcome
from .frames import Answer, Frame, Hello, TipData
from .hand import ALL_TIPS, MAX_TIPS, HandClient, TipHello

__all__ = ["Loaded", "TipFile", "load", "read_back", "roll_back"]

#: How often a command is sent before it is given up.
TRIES = 20
#: How often a load is begun.
BEGINNINGS = 5
#: How long a connection may be gone, s.
GONE = 30.0
#: How long a board may take to restart, s.
RESTART = 10.0
#: Bytes of a chunk, and of a part that is read back.
CHUNK, READ_BACK = 64, 56
#: How long an answer may take, s: an erasure takes two seconds at most, and the board waits three for it.
_PATIENCE = {CommandKind.BEGIN: 3.5, CommandKind.VERIFY: 1.5, CommandKind.ROLL_BACK: 1.5, CommandKind.ACTIVATE: 1.5}
_USUAL_PATIENCE = 0.25

_HEAD = struct.Struct("<4sHHIIQ")
_REMEDIES = {
    Outcome.OUT_OF_BOUNDS: "the block is longer than its memory; ask a coarser accuracy of the design",
    Outcome.BUSY: "it is about to restart; try again",
    Outcome.NOTHING_TO_UNDO: "nothing was loaded, so that there is nothing to take back",
    Outcome.MEMORY_FAILED: "its flash does not take the block; what was in use still is; try another board",
    Outcome.NO_SUCH_TIP: "it has no such tip; give tip=0",
    Outcome.OUT_OF_ORDER: "it lost track of the load; load again",
    Outcome.OTHER_DESIGN: "the block is of another design than the file; load again",
    Outcome.NOT_ARMED: "it is not armed; load again",
}
_REFUSED = (
    "its length differs",
    "its CRC-32 differs",
    "its layout is not the firmware's",
    "its tables may answer wrongly",
    "a value of it is out of its range",
    "it is for another transducer than the firmware's; make the tip of a design with that [transducer]",
)


@dataclass(frozen=True, slots=True)
class TipFile:
    """The file that ``designer tip`` writes (model-tables/src/block/LAYOUT.md)."""

    #: Its bytes.
    content: bytes
    #: Hash of its design.
    design_hash: int

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> TipFile:
        """Reads and checks a tip file.

        Raises:
            TelemetryError: it cannot be read, or is none.
        """
        try:
            content = Path(path).read_bytes()
        except OSError as error:
            raise TelemetryError(f"{os.fspath(path)}: the tip file cannot be read: {error.strerror}") from error
        return cls.of(content, os.fspath(path))

    @classmethod
    def of(cls, content: bytes, name: str = "the tip") -> TipFile:
        """Checks magic, length and CRC-32 of a block; the board checks the rest.

        Raises:
            TelemetryError: it is none.
        """
        if len(content) < _HEAD.size or content[:4] != b"FTIP":
            raise TelemetryError(f"{name}: it is no tip file; `designer tip` writes one")
        _, _, _, length, check, design_hash = _HEAD.unpack_from(content)
        if length != len(content):
            raise TelemetryError(f"{name}: it has {len(content)} bytes, its head has {length}: copy it again")
        found = zlib.crc32(content[:12] + content[16:])
        if found != check:
            raise TelemetryError(f"{name}: its CRC-32 is {found:08x}, its head has {check:08x}: copy it again")
        return cls(content, design_hash)


@dataclass(frozen=True, slots=True)
class Loaded:
    """What came of it."""

    #: Hash of the design in use.
    design_hash: int
    #: Commands that were sent more than once.
    repeated: int


class _BeginAgain(Exception):
    """The board no longer has what was sent."""

    def __init__(self, outcome: Outcome) -> None:
        self.outcome = outcome


class _Job:
    """Commands one at a time."""

    def __init__(self, client: Client) -> None:
        self.client = client
        #: The tip that answers.
        self.tip = client.tip if isinstance(client, HandClient) else 0
        self.repeated = 0
        self._clock = 0
        #: Resets of the board that were seen.
        self.resets = 0
        self.was_reset = False
        self.design_hash: int | None = None
        self._end = client.listen(self._hear)

    def __enter__(self) -> _Job:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def _hear(self, frame: Frame | None) -> None:
        if frame is not None:
            if frame.time_us + RESET < self._clock:
                self.resets += 1
                self.was_reset = True
            self._clock = frame.time_us

    def refuse(self, reason: str) -> TelemetryError:
        return TelemetryError(f"{self.client.address.text}: {reason}")

    def refused(self, kind: CommandKind, outcome: Outcome, findings: int = 0) -> TelemetryError:
        if outcome == Outcome.BLOCK_REFUSED:
            reasons = ", ".join(words for bit, words in enumerate(_REFUSED) if findings >> bit & 1)
            remedy = f"the tip cannot be used there: {reasons}"
        elif (kind, outcome) == (CommandKind.READ_BACK, Outcome.OUT_OF_ORDER):
            remedy = "no loaded tip is in use, its image's own tables are; load one first"
        else:
            remedy = _REMEDIES.get(outcome, outcome.word)
        return self.refuse(f"the board refused `{kind.word}`: {remedy}")

    def ask(self, kind: CommandKind, payload: bytes, wanted: Callable[[Frame, int], bool]) -> Frame:
        """Sends until what is wanted comes."""
        self.was_reset = False
        tries, gone, sequence = 0, None, None
        while tries < TRIES:
            if not self.client.is_connected:
                gone = gone or time.monotonic()
                if time.monotonic() - gone > GONE:
                    raise self.refuse("no connection; see that the board is plugged in, and load again")
                time.sleep(0.05)
                continue
            if gone is not None:
                # Another line: as if it was never asked.
                gone, tries = None, 0
            self.repeated += tries > 0
            tries += 1
            patience = _PATIENCE.get(kind, _USUAL_PATIENCE)
            if sequence is None:
                found = self.client.ask(kind, payload, wanted, patience)
                sequence = self.client.last_sequence
            else:
                found = self.client.ask_again(kind, payload, sequence, wanted, patience)
            if found is not None:
                return found
        if kind == CommandKind.INFO:
            raise self.refuse("no board answers; see that it is a fingertip's port, at its speed")
        if kind == CommandKind.ARM:
            raise self.refuse(
                "the board does not answer `arm`: its firmware was built without the feature load-tip; flash one that has it"
            )
        raise self.refuse(f"the board no longer answers (`{kind.word}`); see to the line and load again")

    def hello(self) -> Hello | TipHello:
        """Asks for the greeting of the board, of a hand of the tip."""
        if isinstance(self.client, HandClient):
            hello = self.ask(CommandKind.INFO, b"", lambda frame, _: isinstance(frame, TipHello) and frame.tip == self.tip)
        else:
            hello = self.ask(CommandKind.INFO, b"", lambda frame, _: isinstance(frame, Hello))
        assert isinstance(hello, (Hello, TipHello))
        self.design_hash = hello.design_hash
        return hello

    def answer(self, kind: CommandKind, payload: bytes) -> Answer:
        def wanted(frame: Frame, sequence: int) -> bool:
            own = isinstance(frame, Answer) and (frame.command, frame.command_sequence) == (kind, sequence)
            return own and frame.tip == self.tip

        answer = self.ask(kind, payload, wanted)
        assert isinstance(answer, Answer)
        return answer

    def arm(self) -> None:
        answer = self.answer(CommandKind.ARM, b"LOAD")
        if answer.outcome != Outcome.DONE:
            raise self.refused(CommandKind.ARM, answer.outcome)

    def done(self, kind: CommandKind, payload: bytes = b"") -> None:
        """Sends a command until it is done; arms the board where it is not."""
        for _ in range(BEGINNINGS):
            answer = self.answer(kind, payload)
            if answer.outcome == Outcome.DONE:
                return
            if answer.outcome == Outcome.NOT_ARMED:
                self.arm()
                continue
            if answer.outcome in (Outcome.OUT_OF_ORDER, Outcome.MEMORY_FAILED):
                raise _BeginAgain(answer.outcome)
            raise self.refused(kind, answer.outcome, answer.findings)
        raise self.refused(kind, Outcome.NOT_ARMED)

    def restart(self, kind: CommandKind, payload: bytes = b"", wanted: int | None = None) -> Hello | TipHello:
        """Sends what ends in a restart, and waits for the board to come back, with the design that is wanted of it if one is."""
        before = self.resets
        for _ in range(BEGINNINGS):
            answer = self.answer(kind, payload)
            # It had been done and the answer was lost: the board is restarting, or has.
            done = answer.outcome in (Outcome.DONE, Outcome.BUSY)
            forgotten = answer.outcome in (Outcome.NOT_ARMED, Outcome.OUT_OF_ORDER)
            if forgotten and wanted is not None:
                # After a reset of before the command the load is forgotten too: the design in use tells which it was.
                hello = self.hello()
                if hello.design_hash == wanted:
                    return hello
            elif forgotten and self.was_reset:
                done = True
            if done:
                return self._back(before, wanted)
            if answer.outcome == Outcome.NOT_ARMED:
                self.arm()
                continue
            if answer.outcome in (Outcome.OUT_OF_ORDER, Outcome.MEMORY_FAILED):
                raise _BeginAgain(answer.outcome)
            raise self.refused(kind, answer.outcome, answer.findings)
        raise self.refused(kind, Outcome.NOT_ARMED)

    def _back(self, resets: int, wanted: int | None) -> Hello | TipHello:
        """Waits for the board, which had so many resets before; another design in use is a sign of one too.

        Where a design is wanted, another one ends the wait only when its time is over: a reset of before the command may be noticed late.
        """
        until = time.monotonic() + RESTART
        back: Hello | TipHello | None = None
        while time.monotonic() < until:
            before = self.design_hash
            hello = self.hello()
            if hello.design_hash == wanted:
                return hello
            if self.resets > resets or hello.design_hash != before:
                back = hello
                if wanted is None:
                    return hello
        if back is not None:
            return back
        raise self.refuse("the board did not come back after the restart; switch it off and on")


def load(
    client: Client,
    tip_file: TipFile | str | os.PathLike[str],
    *,
    tip: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Loaded:
    """Loads a tip file and has the board use it; the load ends with the board's restart.

    Args:
        client: a client of a board whose firmware has the feature ``load-tip``.
        tip: which tip of the board, from 0; ``None``: the client's, of a hand, and else the one there is.
        progress: is called with the bytes written and the bytes of the file.

    Raises:
        TelemetryError: the file is no tip, or the board refused or went, with the remedy.
    """
    block = tip_file if isinstance(tip_file, TipFile) else TipFile.read(tip_file)
    _one(client, tip)
    if tip is None:
        tip = client.tip if isinstance(client, HandClient) else 0
    if not 0 <= tip <= 15:
        raise TelemetryError(f"tip is {tip}: must be 0 to 15")
    content = block.content
    (check,) = struct.unpack_from("<I", content, 12)
    begin = struct.pack("<BII", tip, len(content), check)
    with _Job(client) as job:
        job.hello()
        job.arm()
        kind, outcome = CommandKind.BEGIN, Outcome.OUT_OF_ORDER
        for _ in range(BEGINNINGS):
            try:
                kind = CommandKind.BEGIN
                job.done(kind, begin)
                kind = CommandKind.CHUNK
                for offset in range(0, len(content), CHUNK):
                    job.done(kind, struct.pack("<I", offset) + content[offset : offset + CHUNK])
                    if progress is not None:
                        progress(min(offset + CHUNK, len(content)), len(content))
                kind = CommandKind.VERIFY
                job.done(kind)
                kind = CommandKind.ACTIVATE
                hello = job.restart(kind, struct.pack("<Q", block.design_hash), wanted=block.design_hash)
            except _BeginAgain as again:
                outcome = again.outcome
                continue
            if hello.design_hash != block.design_hash:
                raise job.refuse(
                    f"the board is back with design {hello.design_hash:016x}, which is not the one that was to be in use; load again"
                )
            return Loaded(hello.design_hash, job.repeated)
        raise job.refused(kind, outcome)


def _one(client: Client, tip: int | None = None) -> None:
    """Refuses a hand's client that does not name the one tip that the job is for."""
    if not isinstance(client, HandClient):
        return
    if not 0 <= client.tip < MAX_TIPS:
        raise TelemetryError(f"the client's tip is {client.tip}: must be that of one tip, 0 to {MAX_TIPS - 1}, and not {ALL_TIPS}")
    if tip is not None and tip != client.tip:
        raise TelemetryError(f"tip is {tip}, and the client's is {client.tip}: give the client that tip, or leave tip out")


def roll_back(client: Client) -> Loaded:
    """Has the board use what was in use before the last load; ends with its restart. Of a hand the client's tip.

    Raises:
        TelemetryError: nothing was loaded, or the board refused or went, with the remedy.
    """
    _one(client)
    with _Job(client) as job:
        job.hello()
        job.arm()
        try:
            hello = job.restart(CommandKind.ROLL_BACK)
        except _BeginAgain as again:
            raise job.refused(CommandKind.ROLL_BACK, again.outcome) from None
        return Loaded(hello.design_hash, job.repeated)


def read_back(client: Client) -> TipFile:
    """The tip that is in use, of a hand the client's.

    Raises:
        TelemetryError: the image's own tables are in use, or the board went, with the remedy.
    """
    _one(client)
    content = b""
    length = _HEAD.size
    with _Job(client) as job:
        job.hello()
        while len(content) < length:
            start = len(content)
            asked = struct.pack("<IB", start, min(length - start, READ_BACK))

            def wanted(frame: Frame, sequence: int, start: int = start) -> bool:
                if frame.tip != job.tip:
                    return False
                if isinstance(frame, Answer):
                    return (frame.command, frame.command_sequence) == (CommandKind.READ_BACK, sequence)
                return isinstance(frame, TipData) and (frame.command_sequence, frame.offset) == (sequence, start)

            part = job.ask(CommandKind.READ_BACK, asked, wanted)
            if isinstance(part, Answer):
                raise job.refused(CommandKind.READ_BACK, part.outcome)
            assert isinstance(part, TipData)
            content += part.content
            if start < _HEAD.size <= len(content):
                length = max(_HEAD.unpack_from(content)[3], _HEAD.size)
    return TipFile.of(content, f"{client.address.text}: what was read back")
