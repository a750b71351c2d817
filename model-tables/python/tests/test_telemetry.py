"""The telemetry client against the protocol's page, over sockets and pseudo-terminals."""

import asyncio
import os
import re
import socket
import struct
import subprocess
import sys
import threading
import time
import zlib
from pathlib import Path

import numpy as np
import pytest

from fingertip import telemetry
from fingertip.telemetry import (
    AsyncClient,
    Client,
    CommandKind,
    Fault,
    FaultReport,
    Reading,
    Touch,
    Warnings,
    commands,
    frames,
    ports,
)

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "src/link/PROTOCOL.md").read_text(encoding="utf-8")


def example(what):
    """The bytes of an example of the page."""
    row = re.search(rf"^\| {re.escape(what)}[^`]*\| `([0-9a-f ]+)` \|$", PAGE, re.MULTILINE)
    assert row, f"PROTOCOL.md has no example {what!r}"
    return bytes.fromhex(row[1])


def decoded(coded):
    return frames.decode(frames.body_of(coded[:-1]))


def reading(sequence, time_us, *, dropped=0, force_un=1_500_000, warnings=0):
    """A reading as the page has it: 642 Pa in counts of 1/256 Pa, 2.5 mm."""
    body = struct.pack(
        "<BBHQHHBB6i", 2, 1, sequence, time_us, dropped, warnings, 8, 2, 642 * 256, force_un, 2_500_000, 742, 6_000, 9_000
    )
    return frames.framed(body)


def fault(sequence, time_us, reason):
    return frames.framed(struct.pack("<BBHQHB", 2, 2, sequence, time_us, 0, reason))


class Board:
    """The other end of a socket."""

    def __init__(self):
        self._server = socket.create_server(("127.0.0.1", 0))
        self._server.settimeout(10)
        self.address = f"tcp:127.0.0.1:{self._server.getsockname()[1]}"
        self.line = None

    def accept(self):
        self.line, _ = self._server.accept()
        self.line.settimeout(10)
        return self

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.line:
            self.line.close()
        self._server.close()


def until(condition, seconds=10.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it does not come"
        time.sleep(0.005)


def test_the_pages_frames_are_what_the_page_states_of_them():
    found = decoded(example("reading, sequence 0x0102"))
    assert found == Reading(
        0x0102, 3_000_500, 3, 0, Warnings.SATURATED, Touch.TOUCHED, 642.0, 1.5, 2.5, 742 / 256, 6e-3, 9e-3
    ), found
    found = decoded(example("fault, sequence 65535"))
    assert (found.sequence, found.time_us, found.reason) == (65535, 0, Fault.SENSOR_OPEN)
    found = decoded(example("hello, sequence 7"))
    assert (found.firmware, found.design_hash, found.period_us, found.saves) == ((0, 1, 0), 0x0123456789ABCDEF, 1000, 17)
    assert (found.samples_lost, found.samples_replaced, found.frames_dropped, found.refused) == (2, 6, 259, 4)
    found = decoded(example("answer, sequence 9"))
    assert (found.command, found.command_sequence, found.outcome.word) == (CommandKind.INDENTATION, 5, "done")
    assert (found.force_n, found.force_sigma_n) == pytest.approx((1.5, 0.09))
    # 125 000 / km: a ball of 8 mm.
    assert 1e3 / found.curvature_per_m == pytest.approx(8.0)
    found = decoded(example("data, sequence 8"))
    assert (found.offset, found.content) == (0, b"FTIP")


def test_a_feedback_force_stands_behind_a_reading():
    coded = example("feedback, sequence 0x0102")
    found = decoded(coded)
    assert (found.feedback_force_n, found.feedback_force_sigma_n) == pytest.approx((0.445, 0.0018))
    alone = decoded(example("reading, sequence 0x0102"))
    assert alone.feedback_force_n is None and alone.force_n == found.force_n
    batch = telemetry.Batch.of([found, alone])
    assert batch.feedback_force_n[0] == pytest.approx(0.445) and np.isnan(batch.feedback_force_n[1])
    body = frames.body_of(coded[:-1])
    for cut in (body[:46], body[:42] + struct.pack("<2i", -1, 1), body[:42] + struct.pack("<2i", 1, -1)):
        with pytest.raises(frames.FrameError):
            frames.decode(cut)


def test_commands_are_the_pages_bytes():
    for what, kind, sequence, payload in [
        ("tare, sequence 0x0102", CommandKind.TARE, 0x0102, b""),
        ("rate, sequence 1", CommandKind.RATE, 1, commands.rate(10)),
        ("save, sequence 2", CommandKind.SAVE, 2, commands.save(-2500)),
        ("self-test, sequence 3", CommandKind.SELF_TEST, 3, commands.self_test(0.25)),
        ("object, sequence 6", CommandKind.OBJECT, 6, commands.object_("ball", 8.0)),
        ("indentation, sequence 5", CommandKind.INDENTATION, 5, commands.indentation(1.25)),
        ("air, sequence 4", CommandKind.AIR, 4, commands.air(101_325)),
        ("arm, sequence 5", CommandKind.ARM, 5, b"LOAD"),
    ]:
        assert commands.encode(kind, sequence, payload) == example(what), what
    with pytest.raises(telemetry.TelemetryError, match="every is 0: must be 1 to 1000"):
        commands.rate(0)
    with pytest.raises(telemetry.TelemetryError, match="pressure_pa is nan: must be 60000 to 108000"):
        commands.air(float("nan"))


def test_codes_are_the_pages():
    table = PAGE[PAGE.index("| bit | warning |") : PAGE.index("### Kind 2")]
    found = {Warnings(1 << int(bit)): word for bit, word in re.findall(r"^\| (\d+) \| ([a-z ]+) \|", table, re.MULTILINE)}
    assert found == telemetry.codes.WARNING_WORDS
    table = PAGE[PAGE.index("| code | reason |") : PAGE.index("### Kind 3")]
    cells = [cell.strip() for line in table.splitlines()[2:] for cell in line.strip("|").split("|")]
    found = {int(code): re.split("[:,]", word)[0] for code, word in zip(cells[::2], cells[1::2], strict=False) if code.isdecimal()}
    assert found == {fault.value: word for fault, word in telemetry.codes.FAULT_WORDS.items()}
    for code, word in re.findall(r"^\| 0x([0-9a-f]{2}) \| ([a-z -]+) \|", PAGE, re.MULTILINE):
        assert CommandKind(int(code, 16)).word == word.removeprefix("load ").replace(" ", "-")


def test_what_is_no_frame_is_refused_whole():
    sound = example("reading, sequence 0x0102")
    for place in range(len(sound) - 1):
        for flipped in (1, 0x80):
            damaged = bytearray(sound)
            damaged[place] ^= flipped
            for one in frames.Splitter().feed(bytes(damaged)):
                with pytest.raises(frames.FrameError):
                    frames.decode(frames.body_of(one))
    # Sound in CRC, and no frame of this page: a version, a kind, a warning, a touch, a length of another one.
    body = frames.body_of(sound[:-1])
    for place, value in [(0, 3), (1, 9), (15, 0x80), (17, 3), (16, 32)]:
        other = bytearray(body)
        other[place] = value
        with pytest.raises(frames.FrameError):
            frames.decode(bytes(other))
    with pytest.raises(frames.FrameError):
        frames.decode(body + b"\0")


def test_what_is_lost_is_counted_and_told_apart():
    with Board() as board, Client(board.address, capacity=4) as client:
        board.accept()
        # From the middle of a frame on; 12 and 13 are missing, one of them dropped by the board; 14 is broken.
        board.line.sendall(reading(9, 900_000)[7:] + reading(10, 1000_000) + reading(11, 1100_000))
        board.line.sendall(frames.framed(b"\2\1\0") + reading(15, 1500_000, dropped=1) + reading(16, 1600_000, dropped=1))
        until(lambda: client.counts.frames == 4)
        counts = client.counts
        assert (counts.damaged, counts.missing, counts.board_dropped, counts.overflowed) == (2, 3, 1, 0)
        # A reset is no loss; the oldest two leave the buffer.
        board.line.sendall(reading(0, 1_000) + reading(1, 2_000))
        until(lambda: client.counts.frames == 6)
        assert (client.counts.missing, client.counts.resets, client.counts.overflowed) == (3, 1, 2)
        assert [frame.sequence for frame in client.take()] == [15, 16, 0, 1]
        with pytest.raises(TimeoutError):
            client.read(0.01)


def test_the_sequence_wraps_without_a_loss():
    with Board() as board, Client(board.address) as client:
        board.accept().line.sendall(b"".join(reading(n & 0xFFFF, n * 1000) for n in range(65_530, 65_545)))
        until(lambda: client.counts.frames == 15)
        assert client.counts.missing == 0


def test_a_lost_connection_is_sought_again():
    with Board() as board, Client(board.address) as client:
        board.accept().line.sendall(reading(1, 1_000))
        assert client.read(10).sequence == 1
        board.line.close()
        board.accept().line.sendall(reading(7, 9_000))
        assert client.read(10).sequence == 7
        assert client.counts.disconnected == 1 and client.is_connected
        # What went by meanwhile is not known: no number is missing of this connection.
        assert client.counts.missing == 0
    with Board() as board, Client(board.address, reconnect=False) as client:
        board.accept().line.close()
        with pytest.raises(EOFError, match="closed"):
            client.read(10)
    with pytest.raises(telemetry.TelemetryError, match="cannot be opened.*plugged in"):
        Client("tcp:127.0.0.1:9")
    with pytest.raises(telemetry.TelemetryError, match="write tcp:HOST:PORT"):
        Client("tcp:host")


def test_a_batch_holds_readings_and_faults(tmp_path):
    record = tmp_path / "record.bin"
    record.write_bytes(
        reading(0, 500, warnings=1) + example("hello, sequence 7") + fault(1, 1_500, 6) + reading(2, 2_500, force_un=-3)
    )
    with Client(str(record)) as client:
        batch = client.batch(count=10)
    assert batch.time_s == pytest.approx([0.0005, 0.0015, 0.0025]) and len(batch) == 3
    assert batch.fault.tolist() == [0, Fault.CONVERTER_STALLED, 0] and batch.warnings.tolist() == [1, 0, 0]
    assert batch.is_ok.tolist() == [False, False, True]
    assert np.isnan(batch.force_n[1]) and batch.force_n[[0, 2]] == pytest.approx([1.5, -3e-6])
    assert batch.pressure_rise_pa.dtype == np.float64 and batch.touch.tolist() == [2, 0, 2]
    assert len(batch.of_tip(0)) == 3 and len(batch.of_tip(1)) == 0


def answering(board, outcome, delay=0.0):
    """Answers the next command of a line, some readings before it."""

    def run():
        splitter, commanded = frames.Splitter(), []
        while not commanded:
            commanded = list(splitter.feed(board.line.recv(4096)))
        _, kind, sequence = struct.unpack_from("<BBH", frames.body_of(commanded[0]))
        time.sleep(delay)
        answer = struct.pack("<BBHQHBHBH", 2, 4, 3, 3_000, 0, kind, sequence, outcome, 0)
        # Another one's answer first.
        other = struct.pack("<BBHQHBHBH", 2, 4, 2, 2_000, 0, kind, sequence ^ 1, 5, 0)
        board.line.sendall(reading(1, 1_000) + frames.framed(other) + frames.framed(answer))

    thread = threading.Thread(target=run)
    thread.start()
    return thread


def test_a_command_is_answered_refused_or_not_answered(monkeypatch):
    with Board() as board, Client(board.address) as client:
        board.accept()
        thread = answering(board, 0, 0.05)
        assert client.tare().outcome == telemetry.Outcome.DONE
        thread.join()
        thread = answering(board, 1)
        with pytest.raises(telemetry.TelemetryError, match="refused `tare`: touched"):
            client.tare()
        thread.join()
        monkeypatch.setattr(telemetry.client, "_USUAL_PATIENCE", 0.05)
        with pytest.raises(telemetry.TelemetryError, match="does not answer `undo`"):
            client.undo()
        # Frames that came while a command waited are read as ever.
        assert [frame.sequence for frame in client.take()] == [1, 2, 3, 1, 2, 3]


def test_the_asynchronous_client_is_woken_by_frames():
    async def run(board):
        async with AsyncClient(board.address, reconnect=False) as client:
            board.accept()
            sending = threading.Timer(0.05, board.line.sendall, [b"".join(reading(n, 1_000 * n) for n in range(50))])
            sending.start()
            begun = time.process_time()
            first = await asyncio.wait_for(client.read(), 10)
            assert first.sequence == 0
            batch = await client.batch(count=9)
            assert batch.sequence.tolist() == list(range(1, 10))
            thread = answering(board, 0)
            assert (await client.tare()).outcome == telemetry.Outcome.DONE
            thread.join()
            board.line.close()
            rest = [frame.sequence async for frame in client]
            assert rest[:40] == list(range(10, 50)) and len(rest) == 43
            # It waits, and does not turn in circles.
            assert time.process_time() - begun < 2.0

    with Board() as board:
        asyncio.run(run(board))


def test_the_speed_is_set_each_time_a_port_is_opened():
    """macOS forgets the speed when a port is closed; here something else sets it in between."""
    serial = pytest.importorskip("serial")
    termios = pytest.importorskip("termios")
    controller, terminal = os.openpty()
    port = os.ttyname(terminal)

    def speed():
        return termios.tcgetattr(terminal)[5]

    for _ in range(2):
        with Client(port) as client:
            assert speed() == termios.B921600
            os.write(controller, reading(1, 1_000) + fault(2, 2_000, 7))
            assert client.read(10).force_n == pytest.approx(1.5)
            assert isinstance(client.read(10), FaultReport)
            client.write(b"\x07\0")
            assert os.read(controller, 10) == b"\x07\0"
            # The port is this client's alone.
            with pytest.raises(telemetry.TelemetryError, match="cannot be opened.*no other program"):
                Client(port)
        settings = termios.tcgetattr(terminal)
        settings[4] = settings[5] = termios.B9600
        termios.tcsetattr(terminal, termios.TCSANOW, settings)
        assert speed() == termios.B9600
    # A name of Windows is a port's as it is: pyserial puts the prefix to COM10 and above.
    asked = []

    class Port:
        def __init__(self, name, baud, **_):
            asked.append((name, baud))

    serial_class, serial.Serial = serial.Serial, Port
    try:
        ports.Address("COM10").open()
    finally:
        serial.Serial = serial_class
    assert asked == [("COM10", 921_600)]
    os.close(controller)
    os.close(terminal)


def test_telemetry_needs_neither_numpy_nor_the_model():
    code = "import fingertip.telemetry, sys; print([name for name in ('numpy', 'fingertip._fingertip') if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert found.stdout.strip() == "[]"


def test_a_thousand_frames_a_second_take_a_small_part_of_a_core(tmp_path):
    record = tmp_path / "record.bin"
    record.write_bytes(b"".join(reading(n & 0xFFFF, n * 1000) for n in range(10_000)))
    best = float("inf")
    for _ in range(3):
        begun = time.process_time()
        with Client(str(record)) as client:
            batch = client.batch(count=10_000)
        best = min(best, time.process_time() - begun)
        assert len(batch) == 10_000 and client.counts.missing == 0
    # Ten seconds of telemetry in a second of processor time.
    assert best < 1.0, f"{best:.2f} s"
    print(f"{best / 10 * 100:.1f} % of a core at 1 kHz")


def test_a_tip_file_is_checked_before_the_board_is_asked(tmp_path):
    content = struct.pack("<4sHHIIQ", b"FTIP", 1, 40, 24, 0, 0x1111)
    check = zlib.crc32(content[:12] + content[16:])
    sound = content[:12] + struct.pack("<I", check) + content[16:]
    assert telemetry.TipFile.of(sound).design_hash == 0x1111
    path = tmp_path / "tip.bin"
    for wrong, match in [
        (b"", "is no tip file; `designer tip` writes one"),
        (b"FTIX" + sound[4:], "is no tip file"),
        (sound + b"\0", "it has 25 bytes, its head has 24"),
        (sound[:-1] + b"\1", "its CRC-32 is"),
    ]:
        path.write_bytes(wrong)
        with pytest.raises(telemetry.TelemetryError, match=match):
            telemetry.TipFile.read(path)
    with pytest.raises(telemetry.TelemetryError, match="cannot be read: No such file"):
        telemetry.TipFile.read(tmp_path / "missing.bin")
