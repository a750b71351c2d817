"""Where a board is, and the bytes of its line.

A serial port is opened by pyserial (``pip install 'fingertip[serial]'``) on Linux (``/dev/ttyACM0``), macOS
(``/dev/cu.usbmodem1103``; a ``tty.`` device would wait for a carrier) and Windows (``COM3``; pyserial puts the prefix ``\\\\.\\`` to
COM10 and above). The speed is set each time that the port is opened: macOS forgets it when the last program closes the port, so that
``stty`` before a program is not enough there.
"""

from __future__ import annotations

import os
import socket
import stat
import sys
from dataclasses import dataclass
from typing import Protocol

from ..errors import TelemetryError

__all__ = ["BAUD", "Address", "Line"]

#: Speed of the board's serial port, bits a second.
BAUD = 921_600
#: How long a read waits for bytes, s.
PATIENCE = 0.02
#: How long a connection may take, s.
CONNECTING = 2.0
#: How long a write may take, s.
WRITING = 1.0


class Line(Protocol):
    """Both ways of a line."""

    def read(self) -> bytes | None:
        """Bytes that came, empty where none did in a while; ``None`` at the end of a file."""

    def write(self, content: bytes) -> None:
        """Sends bytes."""

    def close(self) -> None:
        """Ends it."""


@dataclass(frozen=True, slots=True)
class Address:
    """A serial port, ``tcp:HOST:PORT``, or a file of recorded bytes; ``-`` is the standard input."""

    text: str
    #: Bits a second, of a serial port.
    baud: int = BAUD
    #: How long a read waits for bytes, s.
    patience: float = PATIENCE

    def __post_init__(self) -> None:
        if not self.text:
            raise TelemetryError("a serial port has a name, such as /dev/ttyACM0")
        if self.text.startswith("tcp:"):
            host, _, port = self.text[4:].rpartition(":")
            if not host or not port.isdecimal() or int(port) > 0xFFFF:
                raise TelemetryError(f"`{self.text}` is no address; write tcp:HOST:PORT, such as tcp:127.0.0.1:4000")

    @property
    def is_file(self) -> bool:
        """Whether it is a file or pipe, which ends."""
        if self.text == "-":
            return True
        try:
            mode = os.stat(self.text).st_mode
        except OSError:
            return False
        return stat.S_ISREG(mode) or stat.S_ISFIFO(mode)

    def open(self) -> Line:
        """Opens the line.

        Raises:
            OSError: it is not there, or another program has it.
            TelemetryError: pyserial is missing.
        """
        if self.text.startswith("tcp:"):
            return _Socket(self.text[4:], self.patience)
        if self.is_file:
            return _File(self.text)
        return _Serial(self.text, self.baud, self.patience)


class _Socket:
    def __init__(self, address: str, patience: float) -> None:
        self._patience = patience
        host, _, port = address.rpartition(":")
        self._socket = socket.create_connection((host.strip("[]"), int(port)), timeout=CONNECTING)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._socket.settimeout(self._patience)

    def read(self) -> bytes:
        try:
            read = self._socket.recv(4096)
        except TimeoutError:
            return b""
        if not read:
            raise ConnectionResetError("the other end closed the connection")
        return read

    def write(self, content: bytes) -> None:
        self._socket.settimeout(WRITING)
        try:
            self._socket.sendall(content)
        finally:
            self._socket.settimeout(self._patience)

    def close(self) -> None:
        self._socket.close()


class _File:
    def __init__(self, path: str) -> None:
        self._file = sys.stdin.buffer if path == "-" else open(path, "rb", buffering=0)

    def read(self) -> bytes | None:
        read = getattr(self._file, "read1", self._file.read)(4096)
        return read or None

    def write(self, content: bytes) -> None:
        raise OSError("a file of recorded bytes takes no commands")

    def close(self) -> None:
        self._file.close()


class _Serial:
    def __init__(self, port: str, baud: int, patience: float) -> None:
        try:
            import serial
        except ImportError:
            raise TelemetryError(
                f"{port}: a serial port needs pyserial, which is not installed: pip install 'fingertip[serial]'"
            ) from None
        # One reader alone: two would have half of the bytes each.
        exclusive = None if os.name == "nt" else True
        self._port = serial.Serial(port, baud, timeout=patience, write_timeout=WRITING, exclusive=exclusive)

    def read(self) -> bytes:
        first = self._port.read(1)
        return first + self._port.read(self._port.in_waiting) if first else b""

    def write(self, content: bytes) -> None:
        self._port.write(content)

    def close(self) -> None:
        self._port.close()
