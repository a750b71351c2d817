#!/usr/bin/env bash
# Packages: haptix 0.2.0, numpy 2.4.6 (PyPI)
#
# Expected: haptix reads CSV files of the BioTac, a fluid-filled fingertip with 19 electrodes,
#   static and dynamic pressure (PDC, PAC) and temperature (TDC, TAC). Its reader documents that it
#   finds columns by their names and works with or without a time column; the package promises raw
#   data that is lossless by construction, behind a checksum. So the order of named columns should
#   not matter, and the sampling rate should be that of the time column.
# Seen: names decide whether the file is a BioTac's, and are then forgotten: the array has the
#   file's order, no name is kept with it, and 19 electrodes are declared. With PDC first,
#   "electrode 1" is the pressure. The time column is dropped, and the rate is 100 Hz whatever it
#   says. A row with an empty cell is dropped too, so a gap of 0.2 s closes without a trace. A first
#   column whose name begins with t counts as time: a file that starts with TDC loses the
#   temperature.
# Why it matters: the checksum covers what was read, so it vouches for all of this. Two rigs' files
#   mix in one training set with pressure under an electrode, and a relaxation time scales with the
#   rig's rate. Reorder and resample before, and pass sampling_rate_hz.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/env"
"$dir/env/bin/pip" install --quiet --disable-pip-version-check numpy==2.4.6
"$dir/env/bin/pip" install --quiet --disable-pip-version-check --no-deps haptix==0.2.0

"$dir/env/bin/python" - "$dir" <<'PY'
import csv
import sys
from pathlib import Path

from haptix.core import InteractionMeta, Labels
from haptix.sensors.biotac import BioTacAdapter

folder = Path(sys.argv[1])
electrodes = [f"E{i}" for i in range(1, 20)]
fluid, heat = ["PDC", "PAC"], ["TDC", "TAC"]


def value(name, row):
    """Electrodes from 1000, pressures 2000 and 2100, temperatures 3000 and 3100; decimals: row."""
    base = {"PDC": 2000, "PAC": 2100, "TDC": 3000, "TAC": 3100}
    return (base[name] if name in base else 999 + int(name[1:])) + row / 100


def read(columns, lost=()):
    """A hold of 20 rows at 50 Hz, one cell empty in the lost ones, through the package's reader."""
    path = folder / "hold.csv"
    with path.open("w", newline="") as f:
        out = csv.writer(f)
        out.writerow(columns)
        for row in range(20):
            cells = [row * 0.02 if c == "time" else value(c, row) for c in columns]
            out.writerow(cells[:-1] + [""] if row in lost else cells)
    reader = BioTacAdapter()
    assert reader.can_load(path)
    return reader.load(path, InteractionMeta(type="pressing"), Labels(material="silicone"))


def show(text, data):
    print(f"{text:<33} {str(data.raw.shape):>8}, first channel {data.raw.array[0, 0]:.0f}, "
          f"{data.sensor.calibration_params['n_electrodes']} electrodes, "
          f"{data.sampling_rate_hz:.0f} Hz, checksum {'good' if data.raw.verify() else 'bad'}")
    return data


named = show("time, electrodes, fluid, heat", read(["time", *electrodes, *fluid, *heat]))
moved = show("time, fluid, heat, electrodes", read(["time", *fluid, *heat, *electrodes]))
ok = named.raw.array[0, 0] == 1000 and moved.raw.array[0, 0] == 2000
ok &= named.sensor.calibration_params == moved.sensor.calibration_params
ok &= named.sampling_rate_hz == moved.sampling_rate_hz == 100 and moved.raw.verify()
ok &= not any("PDC" in str(part).upper() for part in (vars(moved.sensor), moved.labels.to_dict()))

gap = show("ten rows with an empty cell", read(["time", *electrodes, *fluid, *heat], range(5, 15)))
jump = gap.raw.array[5, 0] - gap.raw.array[4, 0]
print(f"  neighbours across the gap: rows 4 and {4 + round(float(jump) * 100)} of the file")
ok &= gap.raw.shape == (10, 23) and round(float(jump) * 100) == 11 and gap.raw.verify()

warm = show("heat, fluid, electrodes, no time", read([*heat, *fluid, *electrodes]))
ok &= warm.raw.shape == (20, 22) and warm.raw.array[0, 0] == 3100
print("as described: names, times and gaps are gone, and the checksum is good" if ok
      else "behaviour changed")
sys.exit(0 if ok else 1)
PY
