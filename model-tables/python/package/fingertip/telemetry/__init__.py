"""The telemetry of a board (src/link/PROTOCOL.md): readings as dataclasses and numpy batches, commands, and tips onto a board.

::

    from fingertip.telemetry import Client, Reading

    with Client("/dev/ttyACM0") as board:
        board.tare()
        for frame in board:
            if isinstance(frame, Reading) and frame.is_ok:
                print(frame.tip, frame.force_n)

A hand of several tips has a client of its own, :class:`HandClient`; :mod:`fingertip.telemetry.ros` makes ROS 2 messages of readings.

Frames, commands and the client need the standard library alone, a serial port pyserial, and a :class:`Batch` numpy.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from ..errors import TelemetryError
from .aio import AsyncClient
from .client import Client, Counts
from .codes import CommandKind, Fault, LastRun, Outcome, ResetCause, Stored, Touch, Warnings
from .frames import Answer, Band, BandRow, FaultReport, Frame, Hello, Reading, TipData
from .hand import ALL_TIPS, HandClient, TipHello
from .load import Loaded, TipFile, load, read_back, roll_back

if TYPE_CHECKING:
    from .batch import Batch

__all__ = [
    "ALL_TIPS",
    "Answer",
    "AsyncClient",
    "Band",
    "BandRow",
    "Batch",
    "Client",
    "CommandKind",
    "Counts",
    "Fault",
    "FaultReport",
    "Frame",
    "HandClient",
    "Hello",
    "LastRun",
    "Loaded",
    "Outcome",
    "Reading",
    "ResetCause",
    "Stored",
    "TelemetryError",
    "TipData",
    "TipFile",
    "TipHello",
    "Touch",
    "Warnings",
    "load",
    "read_back",
    "roll_back",
]


def __getattr__(name: str) -> Any:
    # It needs numpy.
    if name == "Batch":
        return importlib.import_module(".batch", __name__).Batch
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
