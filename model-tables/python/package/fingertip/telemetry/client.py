"""A board's frames as they come: a thread reads the line, a bounded buffer holds them, and what is lost is counted."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..errors import TelemetryError
from . import commands
from .codes import CommandKind, Outcome
from .frames import LONGEST, Answer, FaultReport, Frame, FrameError, Hello, Reading, Splitter, body_of, decode
from .ports import BAUD, PATIENCE, Address, Line
from .shared import QUIET, turns

if TYPE_CHECKING:
    from .batch import Batch

__all__ = ["CAPACITY", "Client", "Counts"]

#: Frames that the buffer holds: a minute of one tip at 1 kHz.
CAPACITY = 60_000
#: From a lost connection to the next try, s.
RETRY = 0.5
#: A board whose clock stands this much lower than before was reset, us: the times of reports lag by less.
RESET = 50_000
#: How long a command may take, s: a tare 2.3, a save 5.
_PATIENCE = {CommandKind.TARE: 3.0, CommandKind.SAVE: 6.0, CommandKind.FORGET: 6.0}
_USUAL_PATIENCE = 1.0


@dataclass(frozen=True, slots=True)
class Counts:
    """What came and what did not, since the client began."""

    #: Frames that came whole.
    frames: int = 0
    #: Stretches between two zeros that are no frame: noise, or another version.
    damaged: int = 0
    #: Frames that are missing in the sequence, those of ``board_dropped`` among them.
    missing: int = 0
    #: Frames that the board dropped because the line was not free.
    board_dropped: int = 0
    #: Frames that left the full buffer unread, the oldest first.
    overflowed: int = 0
    #: Resets of the board that were seen.
    resets: int = 0
    #: Connections that were lost.
    disconnected: int = 0


class Client:
    """A board behind a serial port or socket, or a file of its bytes.

    Args:
        address: ``/dev/ttyACM0``, ``/dev/cu.usbmodem1103``, ``COM10``, ``tcp:HOST:PORT``, a file, or ``-``.
        baud: speed of a serial port, bits a second.
        capacity: frames that wait unread at most; beyond it the oldest leaves and is counted.
        reconnect: whether a lost connection is sought again, twice a second.
        poll: for a shared line (RS-485): how long it is silent, s, before the host gives the board the turn, 0.001 to 1; more than the
            adapter holds bytes back. 0.003 suits a board that reports each millisecond. A board that does not answer for 2.5 s is a lost
            connection. ``None``: the line is the board's own, and it sends unasked.

    Raises:
        TelemetryError: the first connection is not to be had, or an argument is out of its range.
    """

    #: Bytes of the longest frame without its zero.
    _longest = LONGEST

    def __init__(
        self,
        address: str,
        *,
        baud: int = BAUD,
        capacity: int = CAPACITY,
        reconnect: bool = True,
        poll: float | None = None,
    ) -> None:
        if capacity < 1:
            raise TelemetryError(f"capacity is {capacity}: must be 1 or more")
        if poll is not None and not QUIET <= poll <= 1.0:
            raise TelemetryError(f"poll is {poll}: must be {QUIET} to 1 s")
        self._poll = poll
        self._outgoing: deque[bytes] = deque()
        self.address = Address(address, baud, PATIENCE if poll is None else min(poll, PATIENCE))
        if poll is not None and self.address.is_file:
            raise TelemetryError(f"{address}: a file of recorded bytes is no shared line; leave poll out")
        self._reconnect = reconnect and not self.address.is_file
        self._buffer: deque[Frame] = deque()
        self._capacity = capacity
        self._changed = threading.Condition()
        self._listeners: list[Callable[[Frame | None], None]] = []
        self._counts = Counts()
        self._last: Frame | None = None
        self._closing = False
        self._ended: str | None = None
        self._sequence = 0
        self._writing = threading.Lock()
        self._commanding = threading.Lock()
        try:
            self._line: Line | None = self.address.open()
        except (OSError, ValueError) as error:
            raise TelemetryError(
                f"{address} cannot be opened: {error}; see that the board is plugged in and that no other program has its port"
            ) from error
        self._thread = threading.Thread(target=self._run, name=f"telemetry of {address}", daemon=True)
        self._thread.start()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connection; what is in the buffer can still be read."""
        self._closing = True
        if self._thread is not threading.current_thread():
            self._thread.join()

    @property
    def counts(self) -> Counts:
        """What came and what did not."""
        with self._changed:
            return self._counts

    @property
    def is_connected(self) -> bool:
        """Whether there is a connection now."""
        return self._line is not None

    @property
    def last_sequence(self) -> int:
        """The sequence number of the last new command."""
        return self._sequence

    # The thread.

    def _run(self) -> None:
        reason = "it was closed"
        while not self._closing:
            line = self._line
            if line is None:
                try:
                    self._line = self.address.open()
                except (OSError, ValueError, TelemetryError):
                    time.sleep(RETRY)
                continue
            try:
                self._carry(line)
                break
            # pyserial's own errors are OSErrors; on some systems a port that is pulled out raises a TypeError there.
            except (OSError, TypeError) as error:
                reason = str(error)
            self._shut(line)
            if not self._reconnect:
                break
            with self._changed:
                self._counts = replace(self._counts, disconnected=self._counts.disconnected + 1)
            time.sleep(RETRY)
        if self._line is not None:
            self._shut(self._line)
        with self._changed:
            self._ended = reason
            self._changed.notify_all()
            listeners = list(self._listeners)
        for listener in listeners:
            listener(None)

    def _shut(self, line: Line) -> None:
        self._line = None
        try:
            line.close()
        except OSError:
            pass

    def _carry(self, line: Line) -> None:
        """Reads the line until it ends or breaks."""
        splitter = Splitter(self._longest)
        self._last = None
        if self._poll is not None:
            self._outgoing.clear()
            for heard in turns(line, self._poll, self._longest, self._outgoing):
                self._take(splitter.feed(heard))
                if self._closing:
                    return
        while not self._closing:
            read = line.read()
            if read is None:
                return
            if read:
                self._take(splitter.feed(read))

    def _take(self, coded: Iterator[bytes]) -> None:
        frames: list[Frame] = []
        firsts: list[Frame] = []
        damaged = 0
        for one in coded:
            try:
                told = self._decode(body_of(one))
            except FrameError:
                # Joined in its middle, the first stretch is none.
                damaged += 1
                continue
            firsts.append(told[0])
            frames.extend(told)
        with self._changed:
            missing, board, resets = self._follow(firsts)
            self._buffer.extend(frames)
            over = max(len(self._buffer) - self._capacity, 0)
            for _ in range(over):
                self._buffer.popleft()
            counts = self._counts
            self._counts = replace(
                counts,
                frames=counts.frames + len(firsts),
                damaged=counts.damaged + damaged,
                missing=counts.missing + missing,
                board_dropped=counts.board_dropped + board,
                overflowed=counts.overflowed + over,
                resets=counts.resets + resets,
            )
            self._changed.notify_all()
            listeners = list(self._listeners)
        for listener in listeners:
            for frame in frames:
                listener(frame)

    # What a board of several tips has otherwise.

    def _decode(self, body: bytes) -> list[Frame]:
        """What one frame of the line tells, at least one."""
        return [decode(body)]

    def _encode(self, kind: CommandKind, sequence: int, payload: bytes) -> bytes:
        return commands.encode(kind, sequence, payload)

    def _is_asked(self, frame: Frame) -> bool:
        """Whether an answer is of the tip that was asked."""
        return frame.tip == 0

    def _follow(self, frames: list[Frame]) -> tuple[int, int, int]:
        """Missing frames, those that the board dropped, and resets."""
        missing = board = resets = 0
        for frame in frames:
            last, self._last = self._last, frame
            if last is None:
                continue
            if frame.time_us + RESET < last.time_us:
                resets += 1
                continue
            missing += (frame.sequence - last.sequence - 1) & 0xFFFF
            board += (frame.dropped - last.dropped) & 0xFFFF
        return missing, board, resets

    def listen(self, listener: Callable[[Frame | None], None]) -> Callable[[], None]:
        """Calls back with each frame on the thread that reads, and with ``None`` at the end; returns what ends it."""
        with self._changed:
            self._listeners.append(listener)

        def end() -> None:
            with self._changed:
                if listener in self._listeners:
                    self._listeners.remove(listener)

        return end

    # Reading.

    def read(self, timeout: float | None = None) -> Frame:
        """The next frame.

        Args:
            timeout: how long to wait for it, s; ``None`` is for ever.

        Raises:
            TimeoutError: none came in that time.
            EOFError: there is no more: the file or the connection has ended.
        """
        with self._changed:
            if not self._changed.wait_for(lambda: self._buffer or self._ended is not None, timeout):
                raise TimeoutError(f"{self.address.text}: no frame in {timeout} s")
            if self._buffer:
                return self._buffer.popleft()
            raise EOFError(f"{self.address.text}: {self._ended}")

    def take(self) -> list[Frame]:
        """Every frame that waits, without waiting for more."""
        with self._changed:
            frames = list(self._buffer)
            self._buffer.clear()
            return frames

    def __iter__(self) -> Iterator[Frame]:
        """Frames until the connection ends."""
        while True:
            try:
                yield self.read()
            except EOFError:
                return

    def batch(self, *, count: int | None = None, seconds: float | None = None) -> Batch:
        """The next readings and faults as numpy arrays: so many, or those of so long, or fewer where the line ends.

        Other frames of that time are passed over.
        """
        from .batch import Batch

        if (count is None) == (seconds is None):
            raise TelemetryError("a batch is of a count or of seconds: give one of them")
        until = None if seconds is None else time.monotonic() + seconds
        frames: list[Frame] = []
        while count is None or len(frames) < count:
            try:
                frame = self.read(None if until is None else max(until - time.monotonic(), 0.0))
            except (TimeoutError, EOFError):
                break
            if isinstance(frame, Reading | FaultReport):
                frames.append(frame)
            if until is not None and time.monotonic() >= until:
                break
        return Batch.of(frames)

    # Commands.

    def write(self, content: bytes) -> None:
        """Sends bytes, on a shared line one frame in the host's next turn.

        Raises:
            OSError: there is no connection, or it took nothing.
        """
        line = self._line
        if line is None:
            raise ConnectionError("there is no connection")
        if self._poll is not None:
            self._outgoing.append(content)
            return
        with self._writing:
            line.write(content)

    def ask(
        self, kind: CommandKind, payload: bytes, wanted: Callable[[Frame, int], bool], timeout: float
    ) -> Frame | None:
        """Sends a command with a new sequence number; the first frame that is wanted, or ``None`` in that time."""
        self._sequence = (self._sequence + 1) & 0xFFFF
        return self.ask_again(kind, payload, self._sequence, wanted, timeout)

    def ask_again(
        self, kind: CommandKind, payload: bytes, sequence: int, wanted: Callable[[Frame, int], bool], timeout: float
    ) -> Frame | None:
        """The same with a sequence number that was used before."""
        found: list[Frame] = []
        came = threading.Event()

        def listener(frame: Frame | None) -> None:
            if frame is None or not found and wanted(frame, sequence):
                if frame is not None:
                    found.append(frame)
                came.set()

        content = self._encode(kind, sequence, payload)
        end = self.listen(listener)
        try:
            self.write(content)
            came.wait(timeout)
        except OSError:
            # A line that is broken has no answer.
            time.sleep(min(timeout, RETRY))
        finally:
            end()
        return found[0] if found else None

    def command(self, kind: CommandKind, payload: bytes = b"") -> Answer:
        """Sends a command and waits for its answer.

        Raises:
            TelemetryError: the board refused, or did not answer.
        """

        def wanted(frame: Frame, sequence: int) -> bool:
            own = isinstance(frame, Answer) and (frame.command, frame.command_sequence) == (kind, sequence)
            return own and self._is_asked(frame)

        with self._commanding:
            answer = self.ask(kind, payload, wanted, _PATIENCE.get(kind, _USUAL_PATIENCE))
        if not isinstance(answer, Answer):
            raise TelemetryError(f"{self.address.text}: the board does not answer `{kind.word}`; see to the line, or its firmware")
        if answer.outcome != Outcome.DONE:
            raise TelemetryError(f"{self.address.text}: the board refused `{kind.word}`: {answer.outcome.word}")
        return answer

    def hello(self) -> Hello:
        """Asks the board what it is.

        Raises:
            TelemetryError: it did not answer.
        """
        with self._commanding:
            hello = self.ask(CommandKind.INFO, b"", lambda frame, _: isinstance(frame, Hello), _USUAL_PATIENCE)
        if not isinstance(hello, Hello):
            raise TelemetryError(f"{self.address.text}: no board answers; see that it is a fingertip's port, at its speed")
        return hello

    def tare(self) -> Answer:
        """Nothing presses: takes a new zero, within 2.3 s."""
        return self.command(CommandKind.TARE)

    def undo(self) -> Answer:
        """Takes the last commanded zero back."""
        return self.command(CommandKind.UNDO)

    def save(self, gain_ppm: int | None = None) -> Answer:
        """Saves zero and gain in the board; ``gain_ppm``: parts in a million added to the pressure rise, ``None``: as it is."""
        return self.command(CommandKind.SAVE, commands.save(gain_ppm))

    def forget(self) -> Answer:
        """Forgets what is saved."""
        return self.command(CommandKind.FORGET)

    def rate(self, every: int) -> Answer:
        """Every so many-th report goes on the line, 1 to 1000."""
        return self.command(CommandKind.RATE, commands.rate(every))

    def self_test(self, indentation_mm: float = 0.0) -> Answer:
        """Findings of the board, with the indentation that a stop holds, mm, if there is one."""
        return self.command(CommandKind.SELF_TEST, commands.self_test(indentation_mm))

    def touches(self, shape: str, radius_mm: float = 0.0) -> Answer:
        """What is touched: ``"plate"``, ``"ball"``, ``"cup"`` or ``"cylinder"``, and its radius, mm."""
        return self.command(CommandKind.OBJECT, commands.object_(shape, radius_mm))

    def indentation(self, indentation_mm: float) -> Answer:
        """Force and curvature of the last reading at an indentation, mm, that the hand measured."""
        return self.command(CommandKind.INDENTATION, commands.indentation(indentation_mm))

    def air(self, pressure_pa: float) -> Answer:
        """Pressure of the air around an absolute part, Pa, 60 000 to 108 000."""
        return self.command(CommandKind.AIR, commands.air(pressure_pa))
