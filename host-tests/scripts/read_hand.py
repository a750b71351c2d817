#!/usr/bin/env python3
"""Reads the frames of a hand (src/link/PROTOCOL.md, version 3) from a file, a pipe, a serial port set to 1000000 baud or
tcp:HOST:PORT, and prints one line each; `--encode TIP KIND SEQUENCE [HEX]` writes a command to a tip, 255: to all. It shares
its words with read_frames.py beside it.

    stty -F /dev/ttyACM0 1000000 raw && python3 read_hand.py /dev/ttyACM0
    python3 read_hand.py --encode 255 rate 1 0a00 > /dev/ttyACM0
"""
import struct
import sys

import read_frames
from fingertip.telemetry.codes import FAULT_WORDS, WARNING_WORDS, Fault, Stored, Touch, Warnings
from fingertip.telemetry.frames import FrameError, Splitter, body_of, decode, framed

VERSION = 3
ALL_TIPS = 255
MAX_TIPS = 12
#: Bytes of the longest frame without its zero: more of them in a row are no frame.
LONGEST = 243


def deviation(eighths):
    """What a byte of a frame of readings stands for."""
    return "or more" if eighths == 255 else f"{2 ** (eighths / 8):.0f}"


def reading(part, number, k):
    """One tip's 18 bytes."""
    first, word, rise, force, indentation, a, b, c = struct.unpack("<BH3i3B", part)
    if first & 0x4F != number:
        raise FrameError("field")
    try:
        if first & 0x80:
            return f"tip {number} fault: {FAULT_WORDS[Fault(word)]}"
        touch, warnings = Touch(first >> 4 & 3), Warnings(word)
    except ValueError:
        raise FrameError("field") from None
    words = "; ".join(text for warning, text in WARNING_WORDS.items() if warning in warnings)
    return (f"tip {number} {'warning: ' + words if words else 'ok'}, {touch.name.lower()}, {rise / 2**k:.3f} Pa, {force} uN, "
            f"{indentation} nm, 1-sigma {2 ** (a / 8) / 2**k:.3f} Pa, {deviation(b)} uN, {deviation(c)} nm")


def describe(body):
    """One line for a body of the board's."""
    if len(body) < 15 or body[0] != VERSION:
        raise FrameError("version, kind or length")
    _, kind, sequence, time, dropped = struct.unpack_from("<BBHQH", body)
    head = f"{sequence} {time} us, {dropped} dropped: "
    if kind == 5 and 1 <= body[14] <= MAX_TIPS and len(body) == 16 + 18 * body[14] and body[15] <= 31:
        parts = [body[16 + 18 * tip:34 + 18 * tip] for tip in range(body[14])]
        return head + " | ".join(reading(part, tip, body[15]) for tip, part in enumerate(parts))
    if kind == 3 and len(body) == 62:
        return f"{read_frames.describe(decode(bytes([2]) + body[1:61]))}; {body[61]} tips"
    if kind == 6 and len(body) > 41 and len(body) == 41 + body[40]:
        tip, design, tables, period, stored, saved, outliers = struct.unpack_from("<BQIIBII", body, 14)
        try:
            words, name = read_frames.STORED[Stored(stored)], body[41:].decode()
        except ValueError:
            raise FrameError("field") from None
        return head + (f"tip {tip} {name}, design {design:016x}, tables {tables}, a report each {period} us, stored: {words} ({saved}), "
                       f"{outliers} outliers")
    if kind == 8 or kind == 4 and len(body) == 21:
        answer = read_frames.describe(decode(bytes([2]) + body[1:14] + body[15:]))
        return answer.replace(": ", f": tip {body[14]}: ", 1)
    raise FrameError("version, kind or length")


def encoded(arguments):
    """The frame of a command to a tip, or an error that says what is wrong with the arguments."""
    tip, *rest = arguments or [""]
    if not tip.isdecimal() or not (int(tip) < MAX_TIPS or int(tip) == ALL_TIPS):
        raise ValueError(f"`{tip}` is no tip from 0 to {MAX_TIPS - 1}, nor {ALL_TIPS} for all")
    body = body_of(read_frames.encoded(rest)[:-1])
    return framed(bytes([VERSION]) + body[1:4] + bytes([int(tip)]) + body[4:])


if __name__ == "__main__":
    sys.exit(read_frames.run(sys.argv[1:], encoded, describe, Splitter(LONGEST)))
