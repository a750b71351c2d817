"""The host's end of a shared line (RS-485; src/link/PROTOCOL.md): the board is silent until the host gives it the turn."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator

from .ports import Line

__all__ = ["QUIET", "UNANSWERED", "turns"]

#: Silence before the host sends, s.
QUIET = 0.001
#: How long a polled board may say nothing, s: it greets once a second.
UNANSWERED = 2.5
#: Most frames of a board's turn.
_FRAMES = 16
#: An empty frame: the host has nothing to say, and gives the turn.
_POLL = b"\0"


def turns(line: Line, quiet: float, longest: int, outgoing: deque[bytes]) -> Iterator[bytes]:
    """What the board says, empty where it says nothing: a command or a poll gives it the turn, which is over when it is quiet.

    Args:
        line: the line; a read waits no longer than ``quiet``.
        quiet: silence before the host sends, s.
        longest: bytes of the longest frame without its zero.
        outgoing: commands, one a turn.

    Raises:
        OSError: the line broke, the board does not answer for :data:`UNANSWERED`, or sends without an end.
    """
    answered = time.monotonic()
    while True:
        # Also before the first turn: another program may have given the board one. Only a read that found nothing proves the silence:
        # time alone also passes while bytes wait here.
        heard, came = time.monotonic(), 0
        while True:
            read = line.read() or b""
            if read:
                answered = heard = time.monotonic()
                came += len(read)
            elif time.monotonic() - heard >= quiet:
                break
            if came > _FRAMES * (longest + 1):
                raise OSError("the board does not stop sending, so its line is not a shared one: leave poll out")
            yield read
        if time.monotonic() - answered > UNANSWERED:
            raise OSError(
                f"no answer to polls for {UNANSWERED} s; see that the board has power, and firmware with the feature rs485"
            )
        line.write(outgoing.popleft() if outgoing else _POLL)
