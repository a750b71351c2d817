"""Sweeps in one process and on a cluster whose workers die."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import fingertip
from fingertip import _fingertip, sweep

DESIGNS = Path(__file__).resolve().parents[2] / "designs"


@pytest.fixture
def space(tmp_path):
    """Sixty designs in twenty parts, some of them refused."""
    file = tmp_path / "space.toml"
    file.write_text(
        f"""
design = {str(DESIGNS / "paper-prestretched.toml")!r}
[sweep]
method = "sobol"
seed = 1
count = 59
compute = ["rest", "curve"]
curve_states = 9
designs_per_part = 3
[vary]
"membrane.thickness_mm" = {{ from = 0.1, to = 1.0, scale = "log" }}
"rest.pole_stretch" = {{ from = 1.2, to = 2.3 }}
"press.max_indentation_mm" = {{ from = 1.0, to = 5.0 }}
""",
        encoding="utf-8",
    )
    return file


def parts(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.glob("part-*.parquet"))}


def test_a_sweep_in_this_process_can_be_gone_on_with(space, tmp_path):
    swept = sweep.run(space, tmp_path / "whole")
    assert (swept.designs, swept.before, swept.computed, swept.parts) == (59, 0, 59, 20)
    assert 0 < swept.refused < 59 and "mm" in swept.first_reason
    whole = parts(tmp_path / "whole")
    assert len(whole) == 20
    (tmp_path / "whole" / "part-00007.parquet").unlink()
    assert sweep.run(space, tmp_path / "whole").computed == 3
    assert parts(tmp_path / "whole") == whole
    # Part by part, as a worker computes them.
    folder = _fingertip.SweepFolder(str(space), str(tmp_path / "parts"))
    for part in folder.left():
        content, *_ = sweep.part_of(folder.text, part, folder.manifest)
        folder.write(part, content)
    assert parts(tmp_path / "parts") == whole and folder.left() == []
    assert (tmp_path / "parts" / "_manifest.toml").read_text() == (tmp_path / "whole" / "_manifest.toml").read_text()
    with pytest.raises(fingertip.SweepError, match="another run"):
        sweep.run(space, tmp_path / "parts")
    with pytest.raises(fingertip.SweepError, match="this worker has tables_version = .*the same version"):
        sweep.part_of(folder.text, 0, folder.manifest.replace("tables_version = ", "tables_version = 9"))


def test_the_rows_are_those_of_solve(space, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    sweep.run(space, tmp_path / "out")
    rows = parquet.read_table(tmp_path / "out" / "part-00000.parquet").to_pylist()
    for row in rows:
        design = fingertip.Design(
            DESIGNS / "paper-prestretched.toml",
            membrane={"thickness_mm": row["membrane.thickness_mm"]},
            rest={"pole_stretch": row["rest.pole_stretch"]},
        )
        assert fingertip.rest(design).pressure_kpa == pytest.approx(row["rest_pressure_kpa"], rel=1e-7)
        if row["reason"] is None:
            states = fingertip.solve(design, row["curve_indentation_mm"])
            assert row["curve_force_n"] == pytest.approx(states.force_n, rel=1e-6)


def test_a_worker_that_dies_in_mid_run_changes_no_row(space, tmp_path):
    distributed = pytest.importorskip("distributed")
    sweep.run(space, tmp_path / "one")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, host="127.0.0.1"
    ) as cluster:
        with distributed.Client(cluster) as client:
            workers = client.run(os.getpid)
            killed = []

            def kill():
                while len(parts(tmp_path / "two")) < 4:
                    time.sleep(0.002)
                victim = list(workers.values())[0]
                os.kill(victim, signal.SIGKILL)
                killed.append((victim, len(parts(tmp_path / "two"))))

            (tmp_path / "two").mkdir()
            killer = threading.Thread(target=kill)
            killer.start()
            swept = sweep.run(space, tmp_path / "two", scheduler=client)
            killer.join()
            assert len(workers) == 2 and len(killed) == 1 and killed[0][1] < 20, "it was over before"
        assert (swept.computed, swept.parts) == (59, 20)
        assert parts(tmp_path / "two") == parts(tmp_path / "one")
        # The command, which finds the scheduler by its address, and nothing left to do.
        command = [sys.executable, "-m", "fingertip.sweep", space, "--out", tmp_path / "two", "--scheduler", cluster.scheduler_address]
        found = subprocess.run(command, capture_output=True, text=True, timeout=60)
        assert found.returncode == 0, found.stderr
        assert found.stdout == "designs,ready_before,computed,refused,parts\n59,59,0,0,20\n"


def test_what_cannot_run_is_one_line(space, tmp_path):
    pytest.importorskip("distributed")

    def refused(*arguments):
        command = [sys.executable, "-m", "fingertip.sweep", *arguments]
        found = subprocess.run(command, capture_output=True, text=True, timeout=120)
        assert found.returncode == 1 and found.stdout == ""
        [line] = [line for line in found.stderr.splitlines() if not line.startswith("progress: ")]
        return line

    assert "error: missing.toml" in refused("missing.toml", "--out", tmp_path / "none")
    assert not (tmp_path / "none").exists()
    line = refused(space, "--out", tmp_path / "cluster", "--scheduler", "somewhere://1")
    assert "no Dask scheduler answers there" in line and "dask scheduler" in line
