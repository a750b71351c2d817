"""Calibration and sizing against what they were made from."""

import csv
import tomllib
from pathlib import Path

import numpy as np
import pytest

import fingertip

MODEL_TABLES = Path(__file__).resolve().parents[2]
PAPER = MODEL_TABLES / "designs" / "paper-prestretched.toml"
HUMAN = MODEL_TABLES / "targets" / "human-fingertip.toml"


@pytest.fixture(scope="module")
def bench():
    """A device of a material 1.25 times as stiff: force and pressure of a membrane are proportional to its modulus."""
    states = fingertip.solve(PAPER, np.linspace(0.25, 2.5, 10))
    return {
        "indentation_mm": states.indentation_mm,
        "force_n": 1.25 * states.force_n,
        "pressure_rise_kpa": 1.25 * states.pressure_rise_kpa,
    }


def test_a_fit_finds_the_device_that_was_measured(bench):
    fit = fingertip.fit(PAPER, bench, parameters=["material", "pole-stretch"])
    assert fit["material"].value == pytest.approx(1.25, rel=1e-4) and fit["material"].state == "fitted"
    assert fit["pole-stretch"].value == pytest.approx(2.3, rel=1e-4)
    assert fit["material"].key == "material_factor" and fit["material"].start == 1.0
    assert fit.correlations.shape == (2, 2) and np.diag(fit.correlations) == pytest.approx([1.0, 1.0])
    # A quarter of the design's force was missing.
    assert fit.force_rms_before_n == pytest.approx(0.2 * np.sqrt(np.mean(bench["force_n"] ** 2)), rel=1e-4)
    assert fit.force_rms_n < 1e-3 * fit.force_rms_before_n
    residuals = fit.residuals
    assert residuals.quantity[:2] == ("force_n", "pressure_rise_kpa") and len(residuals.measured) == 20
    assert residuals.measured[::2] == pytest.approx(bench["force_n"])
    assert residuals.fitted[1::2] == pytest.approx(bench["pressure_rise_kpa"], rel=1e-4)
    assert residuals.design[::2] == pytest.approx(bench["force_n"] / 1.25, rel=1e-4)
    assert not residuals.outlier.any() and fit.notes
    # The calibrated design is the device.
    states = fingertip.solve(fit.design, bench["indentation_mm"])
    assert states.force_n == pytest.approx(bench["force_n"], rel=1e-4)
    assert states.pressure_rise_kpa == pytest.approx(bench["pressure_rise_kpa"], rel=1e-4)


def test_a_file_of_a_bench_is_the_same_data(bench, tmp_path):
    file = tmp_path / "bench.csv"
    with open(file, "w", newline="", encoding="utf-8") as text:
        writer = csv.writer(text, delimiter=";")
        writer.writerow(["Depth (um)", "Load (mN)", "side"])
        for depth, force in zip(bench["indentation_mm"], bench["force_n"], strict=True):
            writer.writerow([1e3 * depth, 1e3 * force, "left"])
            writer.writerow([1e3 * depth, 9e3 * force, "right"])
    named = {"indentation_mm": "Depth (um)", "force_n": 2}
    fit = fingertip.fit(PAPER, file, parameters="material", columns_of=named, only={"side": "left"})
    assert fit["material"].value == pytest.approx(1.25, rel=1e-4)
    assert np.isnan(fit.pressure_rise_rms_kpa) and set(fit.residuals.quantity) == {"force_n"}


def test_a_trial_has_zeros_of_its_own(bench):
    zeros = {"a": (0.30, 0.2), "b": (-0.15, 0.0)}
    columns = {name: [] for name in ("trial", "indentation_mm", "force_n", "pressure_rise_kpa")}
    for trial, (cell, transducer) in zeros.items():
        for row, depth in enumerate(bench["indentation_mm"]):
            # A ripple stands for noise.
            ripple = 1e-3 * np.sin(2.399 * row)
            columns["trial"].append(trial)
            columns["indentation_mm"].append(depth)
            columns["force_n"].append(bench["force_n"][row] + cell + ripple)
            columns["pressure_rise_kpa"].append(bench["pressure_rise_kpa"][row] + transducer + ripple)
    fit = fingertip.fit(PAPER, columns, parameters="material", per_trial=["force-offset", "pressure-offset"])
    assert fit["material"].value == pytest.approx(1.25, rel=1e-3)
    found = {(zero.trial, zero.name): zero for zero in fit.trial_zeros}
    assert len(found) == 4
    for trial, (cell, transducer) in zeros.items():
        assert found[trial, "force-offset"].value == pytest.approx(cell, abs=0.01)
        assert found[trial, "pressure-offset"].value == pytest.approx(transducer, abs=0.01)
        assert 0.0 < found[trial, "force-offset"].standard_error < 0.01
    with pytest.raises(fingertip.FitError, match="per_trial has .offset.: must be of indentation-offset"):
        fingertip.fit(PAPER, columns, per_trial="offset")


def test_what_cannot_be_fitted_is_one_line(bench):
    for data, match in [
        ({**bench, "forse": bench["force_n"]}, "data has 'forse': must be of indentation_mm, force_n"),
        ({**bench, "force_n": bench["force_n"][:3]}, "different lengths .indentation_mm 10, force_n 3"),
        ({**bench, "force_n": 1e3 * bench["force_n"]}, "are they in mN"),
        ({"force_n": bench["force_n"]}, "two"),
        ("missing.csv", "missing.csv: the data cannot be read: No such file"),
    ]:
        with pytest.raises(fingertip.FitError, match=match) as error:
            fingertip.fit(PAPER, data)
        assert "\n" not in str(error.value)
    with pytest.raises(fingertip.FitError, match="parameters has .modulus.: must be of material, pole-stretch"):
        fingertip.fit(PAPER, bench, parameters=["modulus"])
    with pytest.raises(fingertip.FitError, match="direction is"):
        fingertip.fit(PAPER, bench, direction="down")


def test_a_sized_design_gives_the_wanted_force():
    target = {
        "name": "soft",
        "target": {"indentation_mm": [0.5, 2.0], "force_n": [0.32, 1.94]},
        "bounds": {
            "radial_semi_axis_mm": [4.0, 10.0],
            "axial_semi_axis_mm": [2.0, 9.0],
            "thickness_mm": [0.3, 1.5],
            "pole_stretch": [1.02, 2.0],
        },
        "materials": {"presets": ["dragon-skin-10"]},
        "transducer": {"range_kpa": [0.0, 100.0]},
    }
    sizing = fingertip.size(target, best=2)
    assert len(sizing.designs) <= 2
    best = sizing.designs[0]
    assert best.material == "dragon-skin-10" and best.model and sizing.presses > 0
    # As the command, it gives designs that get tables.
    for sized in sizing.designs:
        assert fingertip.table(sized.design).size_bytes > 0
    assert sizing.indentation_mm == pytest.approx([0.5, 2.0])
    deviation = best.force_n / [0.32, 1.94] - 1
    assert best.misfit_percent == pytest.approx(100 * np.sqrt(np.mean(deviation**2)), rel=1e-6)
    # The design is written to micrometres and solved on a finer mesh.
    states = fingertip.solve(best.design, sizing.indentation_mm)
    assert states.force_n == pytest.approx(best.force_n, rel=2e-3)
    assert states.pressure_kpa - states.pressure_rise_kpa == pytest.approx([best.rest_pressure_kpa] * 2, rel=2e-3)
    assert states.pressure_kpa[1] == pytest.approx(best.peak_pressure_kpa, rel=2e-3)
    assert best.limit_over_deepest == pytest.approx(best.limit_mm / 2.0)


def test_a_target_that_cannot_be_is_one_line():
    with pytest.raises(fingertip.DesignError, match="the target file cannot be read"):
        fingertip.size("missing.toml")
    text = HUMAN.read_text(encoding="utf-8")
    target = tomllib.loads(text)
    target["materials"]["presets"] = ["rubber"]
    with pytest.raises(fingertip.DesignError, match="`materials.presets`"):
        fingertip.size(target)
    # A dome of 3 mm is not pressed 80 mm deep.
    target = tomllib.loads(text)
    target["materials"]["presets"] = ["ecoflex-00-30"]
    target["target"]["force_n"] = [1.0, 1e4]
    target["bounds"] = {name: 3.0 if name != "pole_stretch" else 1.1 for name in target["bounds"]}
    target["bounds"]["thickness_mm"] = 0.1
    target["target"]["indentation_mm"] = [1.0, 80.0]
    with pytest.raises(fingertip.ModelError, match="widen `.bounds.`"):
        fingertip.size(target)
