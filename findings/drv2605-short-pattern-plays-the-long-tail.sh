#!/usr/bin/env bash
# Packages: drv2605 1.0.0, i2cdevice 1.0.0 (PyPI)
#
# Expected: set_sequence(...) is documented as setting the sequence to be played, up to eight steps.
#   The DRV2605 (SLOS825, registers 0x04 to 0x0B) plays step after step until it meets a zero or has
#   played all eight, so a pattern of one step after a pattern of five should be followed by a zero.
#   set_library(name) should write the library named (register 0x03: 1 to 5 and 7 for motors with an
#   eccentric mass, 6 for linear resonant actuators).
# Seen: only the steps given are written, no zero after them. One click after a pattern of five
#   steps plays the click and then the last four steps of the old pattern; waits in it stay waits.
#   set_library writes 6 for every name. The rated voltage cannot be set at all: the register table
#   has two entries named VOLTAGE, and the supply reading at 0x21 replaces the limits at 0x16.
# Why it matters: a wearer who feels "contact" as one pulse and "slip" as three feels three for both
#   from the first slip on, and an eccentric motor gets the drive made for a resonant one. Each
#   pattern tried alone after a reset is right. Pass all eight steps, zeros at the end.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/env"
"$dir/env/bin/pip" install --quiet --disable-pip-version-check --no-deps \
  drv2605==1.0.0 i2cdevice==1.0.0

"$dir/env/bin/python" - <<'PY'
import sys
from drv2605 import DRV2605, PlayWaveform, WaitMillis


class Part:
    """A bus with one DRV2605: its registers, and what a trigger would play."""

    def __init__(self):
        self.file = bytearray(256)

    def write_i2c_block_data(self, address, register, values):
        self.file[register : register + len(values)] = bytes(values)

    def read_i2c_block_data(self, address, register, count):
        return list(self.file[register : register + count])

    def plays(self):
        """The steps as the datasheet plays them: effect numbers, and waits in ms."""
        steps = []
        for code in self.file[0x04:0x0C]:
            if code == 0:
                break
            steps.append(f"{(code & 0x7F) * 10} ms" if code & 0x80 else f"effect {code}")
        return steps


part = Part()
driver = DRV2605(i2c_dev=part)
slip = (PlayWaveform(1), WaitMillis(100), PlayWaveform(47), WaitMillis(100), PlayWaveform(47))
contact = (PlayWaveform(10),)

driver.set_sequence(*contact)
alone = part.plays()
print("contact, after reset:", ", ".join(alone))
driver.set_sequence(*slip)
long = part.plays()
print("slip:                ", ", ".join(long))
driver.set_sequence(*contact)
after = part.plays()
print("contact, after slip: ", ", ".join(after))
driver.set_sequence(*contact, *[PlayWaveform(0)] * 7)
mended = part.plays()
print("contact, with zeros: ", ", ".join(mended))
ok = (alone == mended == ["effect 10"] and after == alone + long[1:]
      and long == ["effect 1", "100 ms", "effect 47", "100 ms", "effect 47"])

written = {}
for number, name in enumerate(("Empty", "TS2200 A", "TS2200 B", "TS2200 C", "TS2200 D",
                               "TS2200 E", "LRA", "TS2200 F")):
    driver.set_library(name)
    written[name] = part.file[0x03]
    print(f"set_library({name!r}): register 0x03 = {part.file[0x03]}, datasheet {number}")
ok &= set(written.values()) == {6}

try:
    driver._drv2605.set("VOLTAGE", rated=0x3E)
    ok = False
except KeyError as missing:
    print(f"rated voltage: no field {missing} in register VOLTAGE")
print("as described: the tail of the longer pattern stays, and the library is always 6" if ok
      else "behaviour changed")
sys.exit(0 if ok else 1)
PY
