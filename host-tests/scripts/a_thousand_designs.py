#!/usr/bin/env python3
"""A thousand designs three ways: one sweep, a process for each design, scipy's solve_bvp. For development only.

    pip install scipy pyarrow target/wheels/fingertip-*.whl
    cargo build --release -p designer
    python3 host-tests/scripts/a_thousand_designs.py             # about ten minutes; --help has less

The membranes of model-tables/spaces/domes.toml, the first thousand that have all their states, with 33 states each. Processor time of one
core, in turns of so many designs each, so that what else the machine does falls on all alike. solve_bvp takes minutes for what the sweep does
in a second: it solves every N-th of the designs (--bvp-every), and its time for the rest is that times N.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import warnings

import numpy as np
import pyarrow.parquet as parquet
from solve_bvp_reference import Membrane, sweep as solve_bvp_sweep

from fingertip import Design, sweep

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPACE = ROOT / "model-tables/spaces/domes.toml"
PAPER = ROOT / "model-tables/designs/paper-prestretched.toml"
TURNS = 10


def space(folder, count):
    """The sweep of the first designs, as a file."""
    text = SPACE.read_text(encoding="utf-8").replace('"../designs', f'"{ROOT}/model-tables/designs')
    file = folder / "space.toml"
    file.write_text(text.replace("count = 10_000", f"count = {count}").replace('["rest", "curve"]', '["curve"]'), encoding="utf-8")
    return file


def design_of(row):
    return Design(
        PAPER,
        membrane={key: row[f"membrane.{key}"] for key in ("radial_semi_axis_mm", "axial_semi_axis_mm", "thickness_mm")},
        rest={"pole_stretch": row["rest.pole_stretch"]},
        press={"max_indentation_mm": row["press.max_indentation_mm"]},
    )


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--designs", type=int, default=1000)
    words.add_argument("--bvp-every", type=int, default=50, help="solve_bvp takes every so many-th design")
    words.add_argument("--tolerance", type=float, default=1e-4, help="of solve_bvp")
    words.add_argument("--designer", default=str(ROOT / "target/release/designer"))
    options = words.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        # One thread, as the others.
        os.environ["RAYON_NUM_THREADS"] = "1"
        before = time.process_time()
        sweep.run(space(folder, options.designs), folder / "out")
        swept = time.process_time() - before
        rows = parquet.read_table(folder / "out").to_pylist()
        print(f"{len(rows)} designs, of which {sum(row['reason'] is not None for row in rows)} are refused", flush=True)
        kept = [row for row in rows if row["reason"] is None]
        for place, row in enumerate(kept):
            (folder / f"{place}.toml").write_text(design_of(row).text, encoding="utf-8")
        alone = bvp = 0.0
        solved, failed, errors = 0, 0, []
        for turn in range(TURNS):
            turned = range(turn, len(kept), TURNS)
            start = os.times()
            for place in turned:
                depths = ",".join(repr(depth) for depth in kept[place]["curve_indentation_mm"])
                command = [options.designer, "solve", folder / f"{place}.toml", "--indentation-mm", depths]
                subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            end = os.times()
            alone += end.children_user + end.children_system - start.children_user - start.children_system
            for place in turned:
                if place % options.bvp_every:
                    continue
                row = kept[place]
                a, b, h = (1e-3 * row[f"membrane.{key}"] for key in ("radial_semi_axis_mm", "axial_semi_axis_mm", "thickness_mm"))
                membrane = Membrane(a, b, h, 160355.0, 46559.0, row["rest.pole_stretch"])
                depths = 1e-3 * np.array(row["curve_indentation_mm"])
                start = time.process_time()
                try:
                    forces, _, stopped = solve_bvp_sweep(membrane, depths[depths > 0], options.tolerance)
                except RuntimeError as error:
                    forces, stopped = [], str(error)
                bvp += time.process_time() - start
                solved += 1
                if stopped:
                    failed += 1
                    continue
                truth = np.array(row["curve_force_n"])[depths > 0]
                errors.append(np.max(np.abs(np.array(forces) / truth - 1)))
        share = len(kept) / max(solved, 1)
        print("way,core_seconds_per_1000,ratio,designs_run")
        per = 1000 / options.designs
        print(f"one sweep,{swept * per:.1f},1,{options.designs}")
        ratio = alone / len(kept) / (swept / options.designs)
        print(f"a process for each,{1000 * alone / len(kept):.1f},{ratio:.2f},{len(kept)}")
        ratio = bvp * share / len(kept) / (swept / options.designs)
        print(f"solve_bvp tol {options.tolerance:g},{1000 * bvp * share / len(kept):.0f},{ratio:.0f},{solved}")
        print(f"solve_bvp stopped in {failed} of {solved}; worst force error of the others {max(errors, default=float('nan')):.1e}")


if __name__ == "__main__":
    sys.exit(main())
