#!/usr/bin/env python3
"""Reads the board's frames (src/link/PROTOCOL.md) from a file, a pipe, a serial port set to 921600 baud or tcp:HOST:PORT, and
prints one line each; `--encode KIND SEQUENCE [HEX]` writes a command. Nothing but the standard library.

    stty -F /dev/ttyACM0 921600 raw && python3 read_frames.py /dev/ttyACM0
    python3 read_frames.py --encode tare 1 > /dev/ttyACM0

HEX is what goes with the command, low byte first: `--encode rate 2 0a00` asks for every tenth report.
"""
import binascii
import os
import socket
import struct
import sys

VERSION = 2
WARNINGS = ["saturated", "zero unverified", "below zero", "leak suspected", "bubble suspected",
            "calibration refused", "zero aged", "temperature", "clock", "recovering",
            "past unknown"] + [None] * 3 + ["noisy"]
FAULTS = {1: "sensor open", 2: "sensor short", 3: "zeroing", 4: "settling", 5: "samples lost", 6: "converter stalled",
          7: "stuck", 8: "jump", 9: "reset loop", 10: "sensor supply", 16: "sensor absent", 17: "bus fault", 18: "wrong sensor",
          19: "sensor calibration", 20: "sensor busy", 21: "sensor memory", 22: "sensor saturated",
          23: "sensor reset", 24: "sensor implausible"}
TOUCH = ["unknown", "untouched", "touched"]
COMMANDS = {"tare": 0x81, "undo": 0x82, "save": 0x83, "info": 0x84, "self-test": 0x85, "rate": 0x86, "forget": 0x87,
            "object": 0x88, "indentation": 0x89, "air": 0x8A, "arm": 0x90, "begin": 0x91, "chunk": 0x92, "verify": 0x93,
            "activate": 0x94, "roll-back": 0x95, "read-back": 0x96}
# Bytes that go with a command; those that load a tip are for `designer load`.
PAYLOADS = {"tare": 0, "undo": 0, "save": 4, "info": 0, "self-test": 4, "rate": 2, "forget": 0, "object": 5,
            "indentation": 4, "air": 4}
OUTCOMES = ["done", "touched", "restless", "out of bounds", "no reading", "busy", "nothing to undo", "zero unverified",
            "memory failed", "no such object", "no such tip", "out of order", "block refused", "other design",
            "not in this image", "not armed"]
CAUSES = ["unknown", "power-on", "pin", "software", "watchdog", "brown-out", "low power"]
STORED = ["none", "in use", "another design's", "damaged", "unreadable"]
LAST = ["nothing known", "late task", "panic in line", "hard fault at", "hang", "non-maskable interrupt"]
LENGTHS = {1: 42, 2: 15, 3: 61, 4: 20}
# Bytes of the longest frame without its zero: more of them in a row are none.
LONGEST = 83


def stuff(plain):
    """COBS, for fewer than 254 bytes."""
    return b"".join(bytes([len(part) + 1]) + part for part in plain.split(b"\0"))


def unstuff(stuffed):
    plain = bytearray()
    while stuffed:
        code, stuffed = stuffed[0], stuffed[1:]
        if code - 1 > len(stuffed):
            raise ValueError("stuffing")
        plain += stuffed[:code - 1] + b"\0"
        stuffed = stuffed[code - 1:]
    return bytes(plain[:-1])


def frame(body):
    return stuff(body + struct.pack("<H", binascii.crc_hqx(body, 0xFFFF))) + b"\0"


def body_of(stuffed):
    plain = unstuff(stuffed)
    if len(plain) < 2 or struct.pack("<H", binascii.crc_hqx(plain[:-2], 0xFFFF)) != plain[-2:]:
        raise ValueError("CRC")
    return plain[:-2]


def describe(body):
    """One line for a body of the board's."""
    tells = len(body) == 36 and body[1] == 4 and body[14] == COMMANDS["indentation"]
    whole = len(body) > 13 and (LENGTHS.get(body[1]) == len(body) or tells or body[1] == 7 and 21 <= len(body) <= 76)
    if not whole or body[0] != VERSION:
        raise ValueError("version, kind or length")
    _, kind, sequence, time, dropped = struct.unpack_from("<BBHQH", body)
    head = f"{sequence} {time} us, {dropped} dropped: "
    if kind == 1:
        bits, k, touch, rise, force, indentation, *sigmas = struct.unpack_from("<HBB6i", body, 14)
        unknown = bits >> len(WARNINGS) or any(bits >> bit & 1 and not word for bit, word in enumerate(WARNINGS))
        if unknown or k > 31 or touch >= len(TOUCH) or min(sigmas) < 0:
            raise ValueError("field")
        warnings = "; ".join(word for bit, word in enumerate(WARNINGS) if bits >> bit & 1)
        return head + (f"{'warning: ' + warnings if bits else 'ok'}, {TOUCH[touch]}, {rise / 2**k:.3f} Pa, {force} uN, "
                       f"{indentation} nm, 1-sigma {sigmas[0] / 2**k:.3f} Pa, {sigmas[1]} uN, {sigmas[2]} nm")
    if kind == 2:
        if body[14] not in FAULTS:
            raise ValueError("field")
        return head + f"fault: {FAULTS[body[14]]}"
    if kind == 3:
        firmware = ".".join(str(part) for part in body[14:17])
        cause, design, tables, period, stored, last, resets = struct.unpack_from("<BQIIBBB", body, 17)
        where, saved, lost, outliers, frames, refused = struct.unpack_from("<6I", body, 37)
        if cause >= len(CAUSES) or stored >= len(STORED) or last >= len(LAST):
            raise ValueError("field")
        return head + (f"hello, firmware {firmware}, reset by {CAUSES[cause]}, design {design:016x}, tables {tables}, a report "
                       f"each {period} us, stored: {STORED[stored]} ({saved}), before: {LAST[last]} {where:#x}, {resets} "
                       f"resets in a row; {lost} samples lost, {outliers} outliers, {frames} frames dropped, {refused} refused")
    if kind == 7:
        command_sequence, offset = struct.unpack_from("<HI", body, 14)
        return head + f"read-back {command_sequence}: from {offset} on, {body[20:].hex()}"
    command, command_sequence, outcome, findings = struct.unpack_from("<BHBH", body, 14)
    names = {code: name for name, code in COMMANDS.items()}
    if command not in names or outcome >= len(OUTCOMES) or not OUTCOMES[outcome]:
        raise ValueError("field")
    if tells:
        force, force_sigma, curvature, curvature_sigma = struct.unpack_from("<4i", body, 20)
        return head + (f"indentation {command_sequence}: {OUTCOMES[outcome]}, findings {findings:#x}, {force} uN, 1-sigma {force_sigma} uN, "
                       f"curvature {curvature} / km, 1-sigma {curvature_sigma} / km")
    return head + f"{names[command]} {command_sequence}: {OUTCOMES[outcome]}, findings {findings:#x}"


def opened(name):
    """Bytes from a file, a port or tcp:HOST:PORT."""
    if name.startswith("tcp:"):
        host, port = name[4:].rsplit(":", 1)
        return socket.create_connection((host, int(port))).makefile("rb", buffering=0)
    return open(name, "rb", buffering=0)


def stuffed_frames(source):
    waiting = b""
    while read := source.read(4096):
        *frames, waiting = (waiting + read).split(b"\0")
        # Of a stretch without a zero the first bytes are enough to be no frame.
        waiting = waiting[:LONGEST + 1]
        yield from filter(None, frames)


def bodies(source):
    """The bodies that are whole; a stretch that was lost is passed over."""
    for stuffed in stuffed_frames(source):
        try:
            body = body_of(stuffed)
            describe(body)
        except ValueError:
            continue
        yield body


def encoded(arguments):
    """The frame of a command, or a ValueError that says what is wrong with the arguments."""
    if len(arguments) < 2:
        raise ValueError("--encode needs KIND SEQUENCE [HEX]")
    kind, sequence, *rest = arguments
    if kind not in COMMANDS:
        raise ValueError(f"no command `{kind}`; there are {', '.join(COMMANDS)}")
    if not sequence.isdecimal() or int(sequence) > 0xFFFF:
        raise ValueError(f"`{sequence}` is no sequence number from 0 to 65535")
    try:
        payload = bytes.fromhex("".join(rest))
    except ValueError:
        raise ValueError(f"`{' '.join(rest)}` is not hexadecimal") from None
    if len(payload) != PAYLOADS.get(kind, len(payload)):
        raise ValueError(f"with {kind} go {PAYLOADS[kind]} bytes, not {len(payload)}")
    if kind == "rate" and not 1 <= int.from_bytes(payload, "little") <= 1000:
        raise ValueError("a rate is 1 to 1000")
    number = int.from_bytes(payload, "little", signed=True)
    if kind == "save" and number != -2**31 and abs(number) > 100_000:
        raise ValueError("a gain is -100000 to 100000 parts in a million, or 00000080 to keep the one there is")
    if kind == "self-test" and number < 0:
        raise ValueError("an indentation is 0 nm or more")
    return frame(struct.pack("<BBH", VERSION, COMMANDS[kind], int(sequence)) + payload)


def main(arguments):
    try:
        if arguments[:1] == ["--encode"]:
            sys.stdout.buffer.write(encoded(arguments[1:]))
            sys.stdout.buffer.flush()
            return 0
        with opened(arguments[0]) if arguments else sys.stdin.buffer as source:
            for stuffed in stuffed_frames(source):
                try:
                    print(describe(body_of(stuffed)), flush=True)
                except ValueError as error:
                    print(f"no frame: {error}", flush=True)
    except BrokenPipeError:
        # Nobody reads on; what Python still holds must not fail a second time.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except KeyboardInterrupt:
        pass
    except (OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
