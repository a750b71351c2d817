"""The client on a shared line (RS-485), over a pseudo-terminal and sockets: a board that is silent until it has the turn."""

import collections
import os
import select
import socket
import struct
import threading
import time

import pytest

from fingertip.telemetry import Client, CommandKind, Outcome, Reading, TelemetryError, frames
from fingertip.telemetry.shared import turns

#: Silence before the host may send, s (PROTOCOL.md).
QUIET = 0.001


def reading(sequence, time_us):
    return frames.framed(
        struct.pack("<BBHQHHBB6i", 2, 1, sequence & 0xFFFF, time_us, 0, 0, 8, 2, 164352, 1_500_000, 2_500_000, 742, 6_000, 9_000)
    )


class Board(threading.Thread):
    """A report each 5 ms, of which eight wait; sent with the answers when the host gives the turn."""

    def __init__(self, read, write):
        super().__init__(daemon=True)
        self._read, self._write = read, write
        self.is_mute = self.is_rude = self.is_over = False
        self.turns = self.collisions = 0

    def run(self):
        begun, reports, sequence, waiting = time.monotonic(), 0, 0, []
        last, sent_at, commanded = 0, 0.0, b""
        while not self.is_over:
            try:
                heard = self._read()
            except OSError:
                return
            while reports < (time.monotonic() - begun) / 0.005:
                reports += 1
                waiting.append(reading(sequence, 5_000 * reports))
                sequence += 1
            del waiting[:-8]
            gives = False
            for byte in heard or b"":
                self.collisions += time.monotonic() - sent_at < QUIET
                commanded += bytes([byte])
                gives = byte == 0 and last == 0
                last = byte
                if byte == 0 and len(commanded) > 1:
                    _, kind, number = struct.unpack_from("<BBH", frames.body_of(commanded[:-1]))
                    answer = struct.pack("<BBHQHBHBH", 2, 4, sequence & 0xFFFF, 5_000 * reports, 0, kind, number, 0, 0)
                    waiting.append(frames.framed(answer))
                    sequence += 1
                    gives = True
                if byte == 0:
                    commanded = b""
            if (gives or self.is_rude) and not self.is_mute:
                self.turns += 1
                try:
                    for frame in waiting:
                        self._write(frame)
                        sent_at = time.monotonic()
                except OSError:
                    return
                waiting.clear()


def ready(descriptor):
    return bool(select.select([descriptor], [], [], 0.001)[0])


@pytest.fixture
def terminal():
    """A board on a pseudo-terminal, and its port."""
    pytest.importorskip("serial")
    pytest.importorskip("termios")
    controller, port = os.openpty()
    board = Board(lambda: os.read(controller, 64) if ready(controller) else b"", lambda frame: os.write(controller, frame))
    board.start()
    yield board, os.ttyname(port)
    board.is_over = True
    board.join()
    os.close(controller)
    os.close(port)


@pytest.fixture
def sockets():
    """A board behind a socket that is connected again and again, and its address."""
    server = socket.create_server(("127.0.0.1", 0))
    boards = []

    def serve():
        while True:
            try:
                line, _ = server.accept()
            except OSError:
                return
            board = Board(lambda: line.recv(64) if ready(line) else b"", line.sendall)
            board.is_mute, board.is_rude = template.is_mute, template.is_rude
            boards.append(board)
            board.start()

    template = Board(None, None)
    threading.Thread(target=serve, daemon=True).start()
    yield template, boards, f"tcp:127.0.0.1:{server.getsockname()[1]}"
    for board in boards:
        board.is_over = True
    server.close()


def test_a_board_that_waits_for_its_turn_is_read_and_commanded(terminal):
    board, port = terminal
    with Client(port) as client, pytest.raises(TimeoutError):
        client.read(0.3)
    with Client(port, poll=0.003) as client:
        batch = client.batch(count=50)
        assert len(batch) == 50
        answer = client.tare()
        assert (answer.command, answer.outcome) == (CommandKind.TARE, Outcome.DONE)
        assert isinstance(client.read(10), Reading)
        assert client.counts.damaged == 0
    assert board.turns > 10 and board.collisions == 0


def test_a_board_that_stops_answering_is_a_lost_connection_with_its_reason(sockets):
    _, boards, address = sockets
    with Client(address, poll=0.003, reconnect=False) as client:
        client.read(10)
        boards[-1].is_mute = True
        with pytest.raises(EOFError, match=r"no answer to polls for 2.5 s; .*feature rs485"):
            while True:
                client.read(10)
    with Client(address, poll=0.003) as client:
        client.read(10)
        boards[-1].is_mute = True
        with pytest.raises(TelemetryError, match="does not answer `tare`"):
            client.tare()
        # It is found again.
        client.take()
        client.read(10)
        assert client.counts.disconnected == 1


class Waiting:
    """Bytes that wait, then silence; it counts what the host sends into the bytes that wait."""

    def __init__(self):
        self.chunks, self.polls, self.collisions = 10, 0, 0

    def read(self):
        if self.chunks == 0:
            time.sleep(0.001)
            return b""
        self.chunks -= 1
        return b"\1"

    def write(self, _):
        self.polls += 1
        self.collisions += self.chunks > 0


def test_a_program_that_is_slow_to_take_bytes_does_not_send_into_those_that_wait():
    line, taken = Waiting(), 0
    for read in turns(line, 0.002, 64, collections.deque()):
        taken += len(read)
        time.sleep(0.005)
        if line.polls:
            break
    assert (taken, line.collisions) == (10, 0)


def test_a_line_that_is_no_shared_one_is_refused(sockets, tmp_path):
    template, _, address = sockets
    template.is_rude = True
    with Client(address, poll=0.02, reconnect=False) as client, pytest.raises(EOFError, match="leave poll out"):
        while True:
            client.read(10)
    record = tmp_path / "record.bin"
    record.write_bytes(reading(1, 1_000))
    with pytest.raises(TelemetryError, match="no shared line; leave poll out"):
        Client(str(record), poll=0.003)
    for wrong in (0.0, 0.0009, 1.1, float("nan")):
        with pytest.raises(TelemetryError, match="must be 0.001 to 1 s"):
            Client(address, poll=wrong)
