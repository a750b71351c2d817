#!/usr/bin/env python3
"""What a state costs here and elsewhere: this checkout, earlier commits, CasADi, solve_bvp, GetFEM, in one run. For development only.

    apt-get install --no-install-recommends python3-getfem
    pip install casadi numpy scipy
    python3 host-tests/scripts/peers.py --against 876c056 --against 42600e0 --commands --out model-tables/PEERS.md

The harness `peers.rs` is built against each checkout (earlier ones from `git archive`), under `target/peers`. Everything is timed in CPU
time of one thread, the least of several sweeps; the harness runs in turns with the peers, before and after them. Without `--out` the page
goes to the standard output. A peer that is not installed is left out, with a word on the page.
"""

import argparse
import csv
import io
import os
import pathlib
import platform
import re
import resource
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "host-tests/scripts"
FOLDER = ROOT / "target/peers"
# Errors of the force at which the membrane is compared: the fastest setting of each with no larger worst error.
ERRORS = [1.1e-3, 7.6e-5, 4e-7]
# The harness's own settings of which the errors are measured against.
TRUTH = "order 16 density 5 contact 8"
REFINED = "3 x 96"
MANIFEST = """[package]
name = "peers"
version = "0.0.0"
edition = "2024"
publish = false

[[bin]]
name = "peers"
path = "{harness}"

[dependencies]
cpu-time = "1"
model-tables = {{ path = "{model}" }}

[profile.release]
codegen-units = 1

[workspace]
"""


def build(name, checkout):
    """The harness, built against a checkout."""
    folder = FOLDER / name
    folder.mkdir(parents=True, exist_ok=True)
    manifest = MANIFEST.format(harness=SCRIPTS / "peers.rs", model=checkout / "model-tables")
    (folder / "Cargo.toml").write_text(manifest)
    lock = checkout / "Cargo.lock"
    (folder / "Cargo.lock").write_text(lock.read_text())
    command = ["cargo", "build", "--quiet", "--release", "--manifest-path", folder / "Cargo.toml"]
    subprocess.run([*command, "--target-dir", folder / "target"], check=True)
    return folder / "target/release/peers"


def archive(commit):
    """A checkout of a commit."""
    folder = FOLDER / "checkouts" / commit
    if not folder.exists():
        folder.mkdir(parents=True)
        packed = subprocess.run(["git", "archive", commit], cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout
        subprocess.run(["tar", "-x", "-C", folder], input=packed, check=True)
    return folder


def rows(text):
    found = []
    for row in csv.DictReader(io.StringIO(text)):
        row["us"] = float(row["us_per_state"])
        for key in ("pressure_pa", "force_n"):
            row[key] = np.array([float(x) for x in row[key].split()])
        found.append(row)
    return found


def run(command, **options):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, **options).stdout


def fastest(runs):
    """Rows of several runs of one program, each with the least time."""
    best = runs[0]
    for other in runs[1:]:
        for row, again in zip(best, other):
            row["us"] = min(row["us"], again["us"])
    return best


def errors(row, truth, key="force_n"):
    return np.abs(row[key] / truth[key] - 1.0)


def membrane(found, truth):
    """Settings of the membrane with their errors."""
    for row in found:
        if row["model"] == "membrane" and row["settings"] != TRUTH:
            error = errors(row, truth)
            yield row["us"], error.max(), np.median(error), row["settings"], float(row["iterations"])


def casadi(python, sweep):
    command = [python, SCRIPTS / "casadi_peer.py", sweep]
    for row in csv.DictReader(io.StringIO(run(command))):
        if row["us_per_state"]:
            key = "worst_force_error", "median_force_error", "worst_pressure_error"
            worst, median, pressure = (float(row[k]) for k in key)
            yield float(row["us_per_state"]), worst, median, row["settings"], row["way"], pressure


def solve_bvp(sweep_rows):
    """The existing peer, on the same states."""
    import time

    import solve_bvp_reference as peer

    depths = 2.5e-3 * np.arange(1, len(sweep_rows["force_n"]) + 1) / len(sweep_rows["force_n"])
    wall = peer.Membrane(**peer.DESIGNS["paper"])
    # CPU time in place of the clock's.
    peer.time.perf_counter = time.process_time
    for tolerance in (1e-3, 1e-4, 1e-6):
        forces, spent, stopped = peer.sweep(wall, depths, tolerance)
        if stopped:
            print(f"solve_bvp tol {tolerance:g}: {stopped}", file=sys.stderr)
            continue
        error = np.abs(np.array(forces) / sweep_rows["force_n"] - 1.0)
        yield spent * 1e6 / len(forces), error.max(), np.median(error), f"tol {tolerance:g}", "-"


def best(candidates, error):
    """The fastest with no larger worst error."""
    able = [candidate for candidate in candidates if candidate[1] <= error]
    return min(able, default=None, key=lambda candidate: candidate[0])


def membrane_tables(ours, others, peers, truth):
    page = ["| worst error at most | method | setting | worst | median | us a state | over this build |", "|---|---|---|---|---|---|---|"]
    for error in ERRORS:
        reference = best(membrane(ours, truth), error)
        entries = [("this build", reference)]
        entries += [(name, best(membrane(found, truth), error)) for name, found in others.items()]
        entries += [(name, best(found, error)) for name, found in peers.items()]
        for name, entry in entries:
            if entry is None:
                page.append(f"| {error:g} | {name} | none is that accurate | | | | |")
                continue
            us, worst, median, settings = entry[:4]
            page.append(
                f"| {error:g} | {name} | {settings} | {worst:.1e} | {median:.1e} | {us:.1f} | {us / reference[0]:.2f} |"
            )
    return page


def solid_tables(ours, others, getfem):
    page = ["| through x along | method | worst error, % | median, % | ms a state | Newton iterations | over this build |", "|---|---|---|---|---|---|---|"]
    solids = [row for row in ours if row["model"] == "solid"]
    truth = next(row for row in solids if row["settings"] == REFINED)
    for row in solids:
        entries = [("this build", row)]
        for name, found in others.items():
            entries += [(name, x) for x in found if x["model"] == "solid" and x["settings"] == row["settings"]]
        entries += [("GetFEM", x) for x in getfem if x["settings"] == row["settings"]]
        for name, entry in entries:
            error = np.maximum(errors(entry, truth), errors(entry, truth, "pressure_pa")) * 100.0
            page.append(
                f"| {row['settings']} | {name} | {error.max():.3f} | {np.median(error):.3f} | {entry['us'] * 1e-3:.2f} | "
                f"{float(entry['iterations']):.1f} | {entry['us'] / row['us']:.2f} |"
            )
    for entry in getfem:
        same = next(row for row in solids if row["settings"] == entry["settings"])
        page += ["", f"GetFEM against this build on the same elements, {entry['settings']}: pressure within "
                 f"{100 * errors(entry, same, 'pressure_pa').max():.3f} %, force within "
                 f"{100 * errors(entry, same).max():.3f} % in every state."]
    return page


def designer(name, checkout):
    """The command line, built from a checkout."""
    target = FOLDER / name / "designer"
    command = ["cargo", "build", "--quiet", "--release", "--package", "designer"]
    subprocess.run(command, cwd=checkout, check=True, env={**os.environ, "CARGO_TARGET_DIR": str(target)})
    return target / "release/designer"


def seconds(program, checkout):
    """CPU seconds of the commands that take longest, the least of three runs."""
    designs = checkout / "model-tables/designs"
    elastic = designs / "index-fingertip-elastic.toml"
    design = elastic if elastic.exists() else designs / "index-fingertip.toml"
    spent = {}
    with tempfile.TemporaryDirectory() as folder:
        guide = (ROOT / "host-tests/guides/calibrate.md").read_text()
        for name, text in re.findall(r"```\w+ (bench\.csv|tip\.toml)\n(.*?)```", guide, re.DOTALL):
            (pathlib.Path(folder) / name).write_text(re.sub(r"^   ", "", text, flags=re.MULTILINE))
        commands = {
            "table": ["table", design, "--out", "tables"],
            "report": ["report", design, "--out", "page"],
            "fit": ["fit", "tip.toml", "bench.csv", "--fit", "material,pole-stretch", "--out", "calibrated"],
            "size": ["size", checkout / "model-tables/targets/human-fingertip.toml"],
        }
        for name, arguments in commands.items():
            least = float("inf")
            for _ in range(3):
                before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
                done = subprocess.run([program, *arguments], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                least = min(least, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)
                if done.returncode:
                    least = float("nan")
                    break
            spent[name] = least
    return spent


def seconds_table(times):
    """By command and build."""
    page = [f"| command | {' | '.join(times)} |", "|---" * (len(times) + 1) + "|"]
    for command in next(iter(times.values())):
        page.append(f"| {command} | " + " | ".join("-" if np.isnan(spent[command]) else f"{spent[command]:.2f}" for spent in times.values()) + " |")
    return page


def machine():
    names = [line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")]
    return f"{names[0]}, {len(names)} threads, {platform.system()} {platform.machine()}"


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--against", action="append", default=[], metavar="COMMIT", help="an earlier commit; repeatable")
    words.add_argument("--getfem-python", default="/usr/bin/python3", help="the interpreter that has GetFEM")
    words.add_argument("--repeats", type=int, default=3, help="runs of the harness, in turns")
    words.add_argument("--out", type=pathlib.Path, help="the page")
    words.add_argument("--commands", action="store_true", help="also the seconds of whole commands; builds each designer")
    words.add_argument("--without", action="append", default=[], choices=["casadi", "solve_bvp", "getfem"])
    arguments = words.parse_args()

    harnesses = {"this build": build("this", ROOT)}
    for commit in arguments.against:
        harnesses[commit] = build(commit, archive(commit))
    runs = {name: [] for name in harnesses}

    def turn():
        for name, harness in harnesses.items():
            runs[name].append(rows(run([harness])))

    turn()
    truth = next(row for row in runs["this build"][0] if row["settings"] == TRUTH)
    sweep = FOLDER / "sweep.csv"
    count = len(truth["force_n"])
    with open(sweep, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["indentation_mm", "force_n", "pressure_pa"])
        for k in range(count):
            writer.writerow([2.5 * (k + 1) / count, float(truth["force_n"][k]), float(truth["pressure_pa"][k])])
    peers, getfem, notes = {}, [], []
    if "casadi" not in arguments.without:
        found = list(casadi(sys.executable, sweep))
        for way in ("plain", "tuned"):
            peers[f"CasADi, {way}"] = [x for x in found if x[4] == way]
        finest = min(found, key=lambda x: x[1])
        notes.append(
            f"CasADi's most accurate setting, {finest[3]}, differs from this build's finest by {finest[1]:.1e} in force and "
            f"{finest[5]:.1e} in pressure at most."
        )
    turn()
    if "solve_bvp" not in arguments.without:
        peers["solve_bvp"] = list(solve_bvp(truth))
    if "getfem" not in arguments.without:
        for through, along in ((2, 24), (2, 60)):
            command = [arguments.getfem_python, SCRIPTS / "getfem_peer.py", "--through", str(through), "--along", str(along)]
            getfem += rows(run(command, env={"OMP_NUM_THREADS": "1", "PATH": "/usr/bin:/bin"}))
    while len(runs["this build"]) < arguments.repeats:
        turn()
    ours = fastest(runs.pop("this build"))
    others = {name: fastest(found) for name, found in runs.items()}

    times = {}
    if arguments.commands:
        times["this build"] = seconds(designer("this", ROOT), ROOT)
        for commit in arguments.against:
            times[commit] = seconds(designer(commit, archive(commit)), archive(commit))
    page = (SCRIPTS / "peers.md").read_text().replace("{machine}", machine()).replace("{load}", f"{os.getloadavg()[1]:.0f}")
    page = page.replace("{command}", " ".join(["python3 host-tests/scripts/peers.py", *sys.argv[1:]]))
    page = page.replace("{membrane}", "\n".join(membrane_tables(ours, others, peers, truth)))
    page = page.replace("{solid}", "\n".join(solid_tables(ours, others, getfem))).replace("{notes}", "\n".join(notes))
    page = page.replace("{commands}", "\n".join(seconds_table(times)) if times else "Not measured in this run: `--commands`.")
    if arguments.out:
        arguments.out.write_text(page)
    else:
        print(page)


if __name__ == "__main__":
    main()
