"""The client of a hand against the protocol's page, and over a socket; the standard library alone."""

import re
import socket
import struct
import threading
import zlib
from pathlib import Path

from fingertip.telemetry import (
    ALL_TIPS,
    Answer,
    Band,
    CommandKind,
    Fault,
    FaultReport,
    HandClient,
    Hello,
    Outcome,
    Reading,
    Stored,
    TelemetryError,
    TipData,
    TipFile,
    TipHello,
    Touch,
    Warnings,
    commands,
    frames,
    hand,
    load,
    read_back,
    roll_back,
    ros,
)

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "src/link/PROTOCOL.md").read_text(encoding="utf-8")


def example(what):
    """The bytes of an example of the page."""
    row = re.search(rf"^\| hand: {re.escape(what)}[^`]*\| `([0-9a-f ]+)` \|$", PAGE, re.MULTILINE)
    assert row, f"PROTOCOL.md has no example {what!r}"
    return bytes.fromhex(row[1])


def decoded(coded):
    return hand.decode_hand(frames.body_of(coded[:-1]))


def refused(call, wanted=frames.FrameError):
    try:
        call()
    except wanted as error:
        return str(error)
    raise AssertionError("it was taken")


def test_the_pages_frames_are_what_the_page_states_of_them():
    first, second = decoded(example("readings"))
    # 742 counts, 6 mN and 9 um as the eighths of an octave 76, 100 and 105.
    assert first == Reading(
        0x0102, 3_000_500, 3, 0, Warnings.SATURATED, Touch.TOUCHED, 642.0, 1.5, 2.5,
        2 ** (76 / 8) / 256, 1e-6 * 2 ** (100 / 8), 1e-6 * 2 ** (105 / 8),
    ), first  # fmt: skip
    assert second == FaultReport(0x0102, 3_000_500, 3, 1, Fault.SENSOR_OPEN)
    [board] = decoded(example("hello of the board"))
    assert isinstance(board, Hello)
    assert (board.tips, board.period_us, board.design_hash) == (5, 2010, 0x0123456789ABCDEF)
    [tip] = decoded(example("hello of tip 4"))
    assert tip == TipHello(8, 1_000_000, 0, 4, 0x0123456789ABCDEF, 5, 2010, Stored.NONE, 0, 6, "index")
    [answer] = decoded(example("answer of tip 4"))
    assert isinstance(answer, Answer)
    assert (answer.tip, answer.command, answer.command_sequence, answer.outcome) == (4, CommandKind.TARE, 0x0304, Outcome.TOUCHED)


def test_commands_are_the_pages_bytes():
    assert hand.encode(4, CommandKind.TARE, 0x0102) == example("tare of tip 4")
    assert hand.encode(ALL_TIPS, CommandKind.RATE, 1, commands.rate(4)) == example("rate of all")
    assert refused(lambda: hand.encode(12, CommandKind.TARE, 1), TelemetryError) == "`12` is no tip from 0 to 11, nor 255 for all"


def test_a_load_is_the_pages_bytes():
    assert hand.encode(3, CommandKind.ARM, 5, b"LOAD") == example("arm of tip 3")
    begin = struct.pack("<BII", 3, 516, 0x01234567)
    assert hand.encode(3, CommandKind.BEGIN, 5, begin) == example("load begin of tip 3")
    assert hand.encode(3, CommandKind.ACTIVATE, 5, struct.pack("<Q", 0x0123456789ABCDEF)) == example("activate of tip 3")
    assert hand.encode(3, CommandKind.READ_BACK, 5, struct.pack("<IB", 448, 56)) == example("read back of tip 3")
    assert hand.encode(1, CommandKind.OBJECT, 6, commands.object_("ball", 8.0)) == example("object of tip 1")
    [refusal] = decoded(example("answer to a load of tip 3"))
    assert isinstance(refusal, Answer)
    assert (refusal.tip, refusal.command, refusal.outcome, refusal.findings) == (3, CommandKind.VERIFY, Outcome.BLOCK_REFUSED, 8)
    [part] = decoded(example("data of tip 3"))
    assert isinstance(part, TipData)
    assert (part.tip, part.command_sequence, part.offset, part.content) == (3, 5, 0, b"FTIP")
    [known] = decoded(example("answer of tip 1"))
    assert isinstance(known, Answer)
    assert (known.tip, known.command, known.findings, known.force_n) == (1, CommandKind.INDENTATION, 1, 1.5)


def test_a_band_gives_lower_and_upper_of_a_reading():
    [band] = decoded(example("band of tip 4"))
    assert isinstance(band, Band)
    assert (band.tip, band.from_pa, [row.to_pa for row in band.rows]) == (4, 500.0, [2000.0, 82944.0])

    def of(rise, warnings=Warnings(0)):
        return band.of(Reading(1, 2, 0, 4, warnings, Touch.TOUCHED, rise, 1.0, 2.0, 1.0, 0.01, 0.01))

    def near(found, wanted):
        return all(abs(one - other) < 1e-12 for ends, others in zip(found, wanted, strict=True) for one, other in zip(ends, others, strict=True))

    assert near(of(2000.0), ((0.935, 1.225), (1.976, 2.6)))
    assert near(of(2000.1), ((0.664, 1.221), (1.954, 3.172)))
    assert of(499.9) is None and of(82944.1) is None
    assert of(1000.0, Warnings.SATURATED) is None and of(1000.0, Warnings.ZERO_AGED) is not None
    body = frames.body_of(example("band of tip 4")[:-1])
    for changed in (body[:-12], body + bytes(12), body[:15] + b"\x20" + body[16:], body[:16] + b"\x06" + body[17:],
                    body[:21] + body[33:45] + body[21:33]):
        assert refused(lambda body=changed: hand.decode_hand(body)) in ("field", "version, kind or length")


def test_what_no_hand_sends_is_refused():
    body = frames.body_of(example("readings")[:-1])
    assert refused(lambda: hand.decode_hand(body[:-1])) == "version, kind or length"
    assert refused(lambda: hand.decode_hand(bytes([2]) + body[1:])) == "version, kind or length"
    for at, byte in [(14, 0), (14, 13), (15, 32), (16, 1), (16, 0x30), (34, 0xC1), (35, 99), (37, 1)]:
        changed = body[:at] + bytes([byte]) + body[at + 1 :]
        assert refused(lambda body=changed: hand.decode_hand(body)) in ("field", "version, kind or length"), (at, byte)


class FakeHand:
    """Two tips behind a socket; of a save the second one's memory fails, or it is silent."""

    def __init__(self, silent=False):
        self._server = socket.create_server(("127.0.0.1", 0))
        self.address = f"tcp:127.0.0.1:{self._server.getsockname()[1]}"
        self._silent = silent
        #: Of each tip the design in use, and the bytes that were loaded.
        self.designs = [9, 9]
        self.blocks = [b"", b""]
        self._sequence = 0
        threading.Thread(target=self._run, daemon=True).start()

    def _frame(self, kind, rest):
        self._sequence += 1
        return frames.framed(struct.pack("<BBHQH", 3, kind, self._sequence, 1000 * self._sequence, 0) + rest)

    def _greet(self):
        hello = struct.pack("<3BBQIIBBB6I", 0, 1, 0, 1, 7, 5, 2010, 0, 0, 0, 0, 0, 0, 0, 0, 0)
        told = self._frame(3, hello + b"\2")
        for tip, name in enumerate([b"thumb", b"index"]):
            told += self._frame(6, struct.pack("<BQIIBIIB", tip, self.designs[tip], 5, 2010, 0, 0, 0, len(name)) + name)
        return told

    def _loaded(self, kind, tip, sequence, rest):
        """The answer to a command that loads a tip."""
        if kind == CommandKind.BEGIN:
            self.blocks[tip] = bytes(struct.unpack("<II", rest)[0])
        if kind == CommandKind.CHUNK:
            (offset,) = struct.unpack_from("<I", rest)
            block = self.blocks[tip]
            self.blocks[tip] = block[:offset] + rest[4:] + block[offset + len(rest) - 4 :]
        if kind == CommandKind.ACTIVATE:
            (self.designs[tip],) = struct.unpack("<Q", rest)
        if kind == CommandKind.ROLL_BACK:
            self.designs[tip] = 9
        if kind == CommandKind.READ_BACK:
            offset, length = struct.unpack("<IB", rest)
            return self._frame(7, struct.pack("<BHI", tip, sequence, offset) + self.blocks[tip][offset : offset + length])
        return self._frame(4, struct.pack("<BBHBH", tip, kind, sequence, 0, 0))

    def _readings(self):
        return self._frame(5, b"\2\x08" + (b"\x10" + bytes(17)) + (b"\x11" + bytes(17)))

    def _run(self):
        line, _ = self._server.accept()
        with line:
            line.sendall(self._readings())
            splitter = frames.Splitter()
            while read := line.recv(256):
                for coded in splitter.feed(read):
                    body = frames.body_of(coded)
                    version, kind, sequence, tip = struct.unpack_from("<BBHB", body)
                    assert version == 3
                    if kind >= 0x90:
                        line.sendall(self._readings() + self._loaded(CommandKind(kind), tip, sequence, body[5:]))
                        continue
                    told = self._readings() + (self._greet() if kind == 0x84 else b"")
                    for own in [tip] if tip < 2 else [0, 1]:
                        if kind == 0x83 and own == 1 and self._silent:
                            continue
                        outcome = 8 if kind == 0x83 and own == 1 else 0
                        told += self._frame(4, struct.pack("<BBHBH", own, kind, sequence, outcome, 0))
                    line.sendall(told)


def test_a_hand_is_asked_tip_by_tip_or_as_a_whole():
    with HandClient(FakeHand().address) as client:
        assert client.names() == ["thumb", "index"]
        assert client.hello().tips == 2
        assert client.save(2_000).tip == 0
        client.tip = 1
        assert "memory failed" in refused(client.save, TelemetryError)
        assert client.command_all(CommandKind.SAVE, commands.save(None)) == {0: Outcome.DONE, 1: Outcome.MEMORY_FAILED}
        # The choice of a tip stands.
        assert (client.tip, client.tare().tip) == (1, 1)
        counts = client.counts
        assert (counts.missing, counts.damaged, counts.resets) == (0, 0, 0)
        told = client.take()
        readings = [frame for frame in told if isinstance(frame, Reading)]
        assert [frame.tip for frame in readings[:4]] == [0, 1, 0, 1]
        assert readings[0].time_us == readings[1].time_us != readings[2].time_us
        # Two tips in one frame are one frame of the line.
        assert counts.frames == len(told) - len(readings) // 2


def test_a_tip_that_is_silent_is_left_out():
    with HandClient(FakeHand(silent=True).address) as client:
        assert client.command_all(CommandKind.SAVE, commands.save(None), timeout=0.5) == {0: Outcome.DONE}


def test_one_tip_is_loaded_read_back_and_rolled_back():
    body = b"FTIP" + struct.pack("<HHI", 1, 0, 150), struct.pack("<Q", 0x1234) + bytes(range(126))
    block = body[0] + struct.pack("<I", zlib.crc32(body[0] + body[1])) + body[1]
    tip_file = TipFile.of(block)
    fake = FakeHand()
    with HandClient(fake.address, tip=1) as client:
        told = []
        assert load(client, tip_file, progress=lambda done, whole: told.append((done, whole))).design_hash == 0x1234
        assert (fake.designs, fake.blocks, told[-1]) == ([9, 0x1234], [b"", block], (150, 150))
        assert read_back(client).content == block
        assert roll_back(client).design_hash == 9
        assert "give the client that tip" in refused(lambda: load(client, tip_file, tip=0), TelemetryError)
        client.tip = ALL_TIPS
        assert "must be that of one tip" in refused(lambda: load(client, tip_file), TelemetryError)


def test_readings_are_ros_messages_and_faults_none():
    first, second = decoded(example("readings"))
    held = Reading(1, 3_000_500, 0, 1, Warnings(0), Touch.TOUCHED, 642.0, 1.5, 2.5, 3.0, 6e-3, 9e-3)
    assert ros.wrench_stamped(held, "index", offset_ns=1_700_000_000_250_000_000) == {
        "header": {"stamp": {"sec": 1_700_000_003, "nanosec": 250_500_000}, "frame_id": "index"},
        "wrench": {"force": {"x": 0.0, "y": 0.0, "z": -1.5}, "torque": {"x": 0.0, "y": 0.0, "z": 0.0}},
    }
    assert ros.fluid_pressure(held, "index", rest_pa=120_000.0) == {
        "header": {"stamp": {"sec": 3, "nanosec": 500_000}, "frame_id": "index"},
        "fluid_pressure": 120_642.0,
        "variance": 9.0,
    }
    # Saturated: a lower bound of the force, a pressure all the same.
    assert ros.wrench_stamped(first, "thumb") is None
    assert ros.fluid_pressure(first, "thumb", rest_pa=0.0) is not None
    assert ros.wrench_stamped(second, "index") is ros.fluid_pressure(second, "index", rest_pa=0.0) is None


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(f"{name} ... ok")
