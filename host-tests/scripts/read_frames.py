#!/usr/bin/env python3
"""Reads the board's frames (src/link/PROTOCOL.md) from a file, a pipe, a serial port set to 921600 baud or tcp:HOST:PORT, and
prints one line each; `--encode KIND SEQUENCE [HEX]` writes a command. An example of `fingertip.telemetry`
(model-tables/python): it takes the parts of it that need the standard library alone, from the sources beside it.

    stty -F /dev/ttyACM0 921600 raw && python3 read_frames.py /dev/ttyACM0
    python3 read_frames.py --encode tare 1 > /dev/ttyACM0

HEX is what goes with the command, low byte first: `--encode rate 2 0a00` asks for every tenth report.
"""
import os
import socket
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "model-tables/python/package"))

from fingertip.errors import TelemetryError  # noqa: E402
from fingertip.telemetry import Answer, Band, CommandKind, FaultReport, Hello, LastRun, Reading, Stored, TipData  # noqa: E402
from fingertip.telemetry.codes import FAULT_WORDS, WARNING_WORDS  # noqa: E402
from fingertip.telemetry.commands import encode  # noqa: E402
from fingertip.telemetry.frames import FrameError, Splitter, body_of, decode  # noqa: E402

STORED = {Stored.NONE: "none", Stored.IN_USE: "in use", Stored.OTHER_DESIGN: "another design's", Stored.DAMAGED: "damaged",
          Stored.UNREADABLE: "unreadable"}
LAST = {LastRun.NOTHING_KNOWN: "nothing known", LastRun.LATE_TASK: "late task", LastRun.PANIC: "panic in line",
        LastRun.HARD_FAULT: "hard fault at", LastRun.HANG: "hang", LastRun.NON_MASKABLE_INTERRUPT: "non-maskable interrupt",
        LastRun.STACK_OVERFLOW: "stack overflow"}
COMMANDS = {kind.word: kind for kind in CommandKind}


def describe(frame):
    """One line for a frame of the board's."""
    head = f"{frame.sequence} {frame.time_us} us, {frame.dropped} dropped: "
    match frame:
        case Reading():
            warnings = "; ".join(word for warning, word in WARNING_WORDS.items() if warning in frame.warnings)
            felt = "" if frame.feedback_force_n is None else (
                f", feedback {1e6 * frame.feedback_force_n:.0f} uN, 1-sigma {1e6 * frame.feedback_force_sigma_n:.0f} uN")
            return head + (f"{'warning: ' + warnings if warnings else 'ok'}, {frame.touch.name.lower()}, "
                           f"{frame.pressure_rise_pa:.3f} Pa, {1e6 * frame.force_n:.0f} uN, {1e6 * frame.indentation_mm:.0f} nm, "
                           f"1-sigma {frame.pressure_rise_sigma_pa:.3f} Pa, {1e6 * frame.force_sigma_n:.0f} uN, "
                           f"{1e6 * frame.indentation_sigma_mm:.0f} nm{felt}")
        case FaultReport():
            return head + f"fault: {FAULT_WORDS[frame.reason]}"
        case Hello():
            firmware = ".".join(str(part) for part in frame.firmware)
            cause = frame.reset_cause.name.lower().replace("_", "-").replace("low-power", "low power")
            return head + (f"hello, firmware {firmware}, reset by {cause}, design {frame.design_hash:016x}, tables "
                           f"{frame.table_version}, a report each {frame.period_us} us, stored: {STORED[frame.stored]} "
                           f"({frame.saves}), before: {LAST[frame.last_run]} {frame.where:#x}, {frame.resets} resets in a row; "
                           f"{frame.samples_lost} samples lost, {frame.samples_replaced} outliers, {frame.frames_dropped} frames "
                           f"dropped, {frame.refused} refused")
        case Band():
            rows = "; ".join(f"to {row.to_pa:.1f} Pa force {100 * row.force[0]:+.1f} to {100 * row.force[1]:+.1f} %, indentation "
                             f"{100 * row.indentation[0]:+.1f} to {100 * row.indentation[1]:+.1f} %" for row in frame.rows)
            return head + f"object unknown, from {frame.from_pa:.1f} Pa: {rows}"
        case TipData():
            return head + f"read-back {frame.command_sequence}: from {frame.offset} on, {frame.content.hex()}"
        case Answer():
            line = head + (f"{frame.command.word} {frame.command_sequence}: {frame.outcome.word}, findings "
                           f"{frame.findings:#x}")
            if frame.force_n != frame.force_n:
                return line
            return line + (f", {1e6 * frame.force_n:.0f} uN, 1-sigma {1e6 * frame.force_sigma_n:.0f} uN, curvature "
                           f"{1e3 * frame.curvature_per_m:.0f} / km, 1-sigma {1e3 * frame.curvature_sigma_per_m:.0f} / km")


def opened(name):
    """Bytes from a file, a port or tcp:HOST:PORT."""
    if name.startswith("tcp:"):
        host, port = name[4:].rsplit(":", 1)
        return socket.create_connection((host, int(port))).makefile("rb", buffering=0)
    return open(name, "rb", buffering=0)


def encoded(arguments):
    """The frame of a command, or an error that says what is wrong with the arguments."""
    if len(arguments) < 2:
        raise ValueError("--encode needs KIND SEQUENCE [HEX]")
    kind, sequence, *rest = arguments
    if kind not in COMMANDS:
        raise ValueError(f"no command `{kind}`; there are {', '.join(COMMANDS)}")
    if not sequence.isdecimal():
        raise ValueError(f"`{sequence}` is no sequence number from 0 to 65535")
    try:
        payload = bytes.fromhex("".join(rest))
    except ValueError:
        raise ValueError(f"`{' '.join(rest)}` is not hexadecimal") from None
    return encode(COMMANDS[kind], int(sequence), payload)


def run(arguments, encoded, described, splitter):
    """Writes the frame of a command, or prints a line for each frame of a source; gives the exit status."""
    try:
        if arguments[:1] == ["--encode"]:
            sys.stdout.buffer.write(encoded(arguments[1:]))
            sys.stdout.buffer.flush()
            return 0
        with opened(arguments[0]) if arguments else sys.stdin.buffer as source:
            while read := source.read(4096):
                for coded in splitter.feed(read):
                    try:
                        print(described(body_of(coded)), flush=True)
                    except FrameError as error:
                        print(f"no frame: {error}", flush=True)
    except BrokenPipeError:
        # Nobody reads on; what Python still holds must not fail a second time.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except KeyboardInterrupt:
        pass
    except (OSError, ValueError, TelemetryError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:], encoded, lambda body: describe(decode(body)), Splitter()))
