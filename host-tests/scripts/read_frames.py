#!/usr/bin/env python3
"""Reads the board's frames (src/link/PROTOCOL.md) from a file, a pipe, a serial port set to 921600 baud or tcp:HOST:PORT, and
prints one line each; `--encode KIND SEQUENCE [HEX]` writes a command. Nothing but the standard library.

    stty -F /dev/ttyACM0 921600 raw && python3 read_frames.py /dev/ttyACM0
    python3 read_frames.py --encode tare 1 > /dev/ttyACM0
"""
import binascii
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
            "air": 0x8A, "arm": 0x90, "begin": 0x91, "chunk": 0x92, "verify": 0x93, "activate": 0x94, "roll-back": 0x95,
            "read-back": 0x96}
OUTCOMES = ["done", "touched", "restless", "out of bounds", "no reading", "busy", "nothing to undo", "zero unverified",
            "memory failed", "no such object", "no such tip", "out of order", "block refused", "other design",
            "not in this image", "not armed"]
CAUSES = ["unknown", "power-on", "pin", "software", "watchdog", "brown-out", "low power"]
STORED = ["none", "serves", "another design's", "damaged", "unreadable"]
LAST = ["nothing known", "late task", "panic in line", "hard fault at", "hang", "non-maskable interrupt"]
LENGTHS = {1: 42, 2: 15, 3: 61, 4: 20}


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
    whole = len(body) > 13 and (LENGTHS.get(body[1]) == len(body) or body[1] == 7 and 21 <= len(body) <= 76)
    if not whole or body[0] != VERSION:
        raise ValueError("version, kind or length")
    _, kind, sequence, time, dropped = struct.unpack_from("<BBHQH", body)
    head = f"{sequence} {time} us, {dropped} dropped: "
    if kind == 1:
        bits, k, touch, rise, force, indentation, *sigmas = struct.unpack_from("<HBB6i", body, 14)
        unknown = bits >> len(WARNINGS) or any(bits >> bit & 1 and not word for bit, word in enumerate(WARNINGS))
        if unknown or k > 31 or touch >= len(TOUCH):
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
        where, saved, lost, wild, frames, refused = struct.unpack_from("<6I", body, 37)
        if cause >= len(CAUSES) or stored >= len(STORED) or last >= len(LAST):
            raise ValueError("field")
        return head + (f"hello, firmware {firmware}, reset by {CAUSES[cause]}, design {design:016x}, tables {tables}, a report "
                       f"each {period} us, stored {STORED[stored]} ({saved}), before: {LAST[last]} {where:#x}, {resets} "
                       f"resets in a row; {lost} samples lost, {wild} wild, {frames} frames dropped, {refused} refused")
    if kind == 7:
        command_sequence, offset = struct.unpack_from("<HI", body, 14)
        return head + f"read-back {command_sequence}: from {offset} on, {body[20:].hex()}"
    command, command_sequence, outcome, findings = struct.unpack_from("<BHBH", body, 14)
    names = {code: name for name, code in COMMANDS.items()}
    if command not in names or outcome >= len(OUTCOMES):
        raise ValueError("field")
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


def main(arguments):
    if arguments[:1] == ["--encode"]:
        kind, sequence, *rest = arguments[1:]
        body = struct.pack("<BBH", VERSION, COMMANDS[kind], int(sequence)) + bytes.fromhex("".join(rest))
        sys.stdout.buffer.write(frame(body))
        return
    with opened(arguments[0]) if arguments else sys.stdin.buffer as source:
        for stuffed in stuffed_frames(source):
            try:
                print(describe(body_of(stuffed)), flush=True)
            except ValueError as error:
                print(f"no frame: {error}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
