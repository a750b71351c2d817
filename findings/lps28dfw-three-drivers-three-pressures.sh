#!/usr/bin/env bash
# Packages: lps28dfw 0.1.6, embedded-hal 1.0.0, uom 0.36.0 (Rust crates);
#   circuitpython-lps28 0.1.1, adafruit-circuitpython-lps28 1.0.3, adafruit-circuitpython-busdevice
#   5.2.17, adafruit-circuitpython-register 1.13.0 (PyPI)
#
# Expected: the LPS28DFW datasheet (DS13317, sensor characteristics) gives 4096 counts/hPa in mode 1
#   (up to 1260 hPa) and 2048 counts/hPa in mode 2 (up to 4060 hPa). Registers that hold
#   1013.25 hPa should read 1013.25 hPa with any driver of the part.
# Seen: the crate spreads the mode's *range* over 2^24 codes, so 1260 hPa stands for 2^24 where the
#   part means 4096 hPa (and 4060 where it means 8192): it reads 311.7 hPa in mode 1 and 502.2 hPa
#   in mode 2. circuitpython-lps28 divides by 100 although its property is in hPa: 10.13.
#   adafruit-circuitpython-lps28 agrees with the datasheet. All three report plausible noise and
#   react to pressure, the crate with a constant factor.
# Why it matters: a zero taken at rest hides the offset, and the gain error of -69 % (mode 1) or
#   -50 % (mode 2) goes into the force. For this part the full-scale name is not the span of the
#   code: check a driver with one pair of bytes from the datasheet's sensitivity before trusting it.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir -p "$dir/reader/src"
cat >"$dir/reader/Cargo.toml" <<'TOML'
[package]
name = "reader"
version = "0.0.0"
edition = "2021"

[dependencies]
lps28dfw = "=0.1.6"
embedded-hal = "=1.0.0"
uom = { version = "=0.36.0", default-features = false, features = ["f32", "si"] }
TOML
cat >"$dir/reader/src/main.rs" <<'RS'
//! Prints what the crate reads, in hPa, for 1013.25 hPa held in the registers of either mode.
use embedded_hal::i2c::{ErrorType, I2c, Operation};
use lps28dfw::{I2CAddress, Range, LPS28DFW};
use uom::si::pressure::hectopascal;

/// A bus with one part whose pressure registers, from 0x28 on, hold a fixed code.
struct Part {
    code: u32,
}

impl ErrorType for Part {
    type Error = core::convert::Infallible;
}

impl I2c for Part {
    fn transaction(&mut self, _: u8, ops: &mut [Operation<'_>]) -> Result<(), Self::Error> {
        let mut register = 0;
        for op in ops {
            match op {
                Operation::Write(bytes) => register = bytes[0] as usize,
                Operation::Read(out) => {
                    for (i, byte) in out.iter_mut().enumerate() {
                        *byte = self.code.to_le_bytes()[register + i - 0x28];
                    }
                }
            }
        }
        Ok(())
    }
}

fn main() {
    for (range, counts) in [(Range::Range1260hPa, 4096.0), (Range::Range4060hPa, 2048.0)] {
        let code = (1013.25_f64 * counts) as u32;
        let mut sensor = LPS28DFW::new(Part { code }, I2CAddress::Low, range);
        print!("{} ", sensor.read_pressure().unwrap().get::<hectopascal>());
    }
}
RS
crate=$(cd "$dir/reader" && CARGO_TARGET_DIR="$dir/target" cargo run --quiet)

python3 -m venv "$dir/env"
"$dir/env/bin/pip" install --quiet --disable-pip-version-check --no-deps \
  circuitpython-lps28==0.1.1 adafruit-circuitpython-lps28==1.0.3 \
  adafruit-circuitpython-busdevice==5.2.17 adafruit-circuitpython-register==1.13.0

"$dir/env/bin/python" - $crate <<'PY'
import sys
import types

# What the board's own runtime provides: `const`, and types that only annotations name.
sys.modules["micropython"] = types.SimpleNamespace(const=lambda value: value)
sys.modules["busio"] = types.SimpleNamespace(I2C=object, SPI=object)
for name in ("circuitpython_typing", "circuitpython_typing.device_drivers"):
    sys.modules[name] = types.SimpleNamespace(
        ReadableBuffer=object, WriteableBuffer=object, I2CDeviceDriver=object)

import adafruit_lps28
import lps28


class Part:
    """A bus with one LPS28DFW: a register file, identity 0xB4 at 0x0F."""

    def __init__(self, code):
        self.file = bytearray(256)
        self.file[0x0F] = 0xB4
        self.file[0x28:0x2B] = code.to_bytes(3, "little")

    def try_lock(self):
        return True

    def unlock(self):
        pass

    def writeto(self, address, buffer, start=0, end=None):
        data = bytes(buffer[start:end])
        if data:  # an empty write asks whether the part answers
            self.file[data[0] : data[0] + len(data) - 1] = data[1:]

    def writeto_then_readfrom(self, address, out, into, out_start=0, out_end=None,
                              in_start=0, in_end=None):
        n = (len(into) if in_end is None else in_end) - in_start
        into[in_start : in_start + n] = self.file[out[out_start] : out[out_start] + n]


true = 1013.25
mode1, mode2 = (float(v) for v in sys.argv[1:])
community = lps28.LPS28(Part(int(true * 4096))).pressure        # the driver starts in mode 1
adafruit = adafruit_lps28.LPS28(Part(int(true * 2048))).pressure  # the driver starts in mode 2
print(f"registers of both modes hold {true} hPa; each driver documents its answer in hPa")
rows = (("lps28dfw (crate), mode 1", mode1), ("lps28dfw (crate), mode 2", mode2),
        ("circuitpython-lps28, mode 1", community), ("adafruit-circuitpython-lps28, mode 2", adafruit))
for name, value in rows:
    print(f"{name:40}{value:10.3f} hPa   ratio {value / true:.4f}")

ok = (abs(mode1 / true - 1260 / 4096) < 1e-4 and abs(mode2 / true - 4060 / 8192) < 1e-4
      and abs(community / true - 0.01) < 1e-6 and abs(adafruit - true) < 1e-3)
print("as described: one code, three pressures" if ok else "behaviour changed")
sys.exit(0 if ok else 1)
PY
