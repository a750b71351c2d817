"""Calibration: a design and bench data to the device that was measured."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from . import _fingertip
from .errors import FitError
from .model import Bools, Design, DesignLike, Floats, columns, design_of

#: Quantities that bench data hold, two of them at least, in the unit that their name ends with.
QUANTITIES = ("indentation_mm", "force_n", "pressure_rise_kpa")

#: Bench data: the path of a CSV file, or arrays by the names of their columns.
DataLike = str | os.PathLike[str] | Mapping[str, ArrayLike]


@dataclass(frozen=True, slots=True)
class FittedParameter:
    """A parameter of a fit."""

    #: As ``"material"``.
    name: str
    #: Its key in ``[calibration]``; empty for what is the bench's alone.
    key: str
    #: The design's value.
    start: float
    #: The fitted value, or the one it was held at.
    value: float
    #: Standard error, of the noise alone; nan where it was held, or with as many parameters as data.
    standard_error: float
    #: ``"fitted"``, or why it was held.
    state: str


@dataclass(frozen=True, slots=True)
class TrialZero:
    """What a channel reads of the untouched tip in one trial."""

    #: Name of the trial.
    trial: str
    #: ``"indentation-offset"`` (mm), ``"force-offset"`` (N) or ``"pressure-offset"`` (kPa).
    name: str
    #: In the unit of its name.
    value: float
    #: Standard error, of the noise alone; nan with as many parameters as data.
    standard_error: float


@dataclass(frozen=True, slots=True)
class Residuals:
    """Every measured number beside what design and fit give, one an element."""

    #: ``"force_n"`` or ``"pressure_rise_kpa"``: the unit of measured, design and fitted.
    quantity: tuple[str, ...]
    #: Line of the CSV file; of arrays 2 for the first element.
    line: Floats
    #: Name of the trial; empty without.
    trial: tuple[str, ...]
    #: Indentation of the row, mm; nan where it was not measured.
    indentation_mm: Floats
    #: What was measured.
    measured: Floats
    #: What the design gives.
    design: Floats
    #: What the fit gives.
    fitted: Floats
    #: Measured less fitted, in standard deviations of the noise.
    standardised: Floats
    #: Whether it counted for (almost) nothing.
    outlier: Bools


@dataclass(frozen=True, slots=True)
class Fit:
    """A calibration. Misfits are root mean squares without outliers; nan where the quantity was not measured."""

    #: The design with its ``[calibration]``, comments kept.
    design: Design
    #: Every parameter chosen, fitted or held.
    parameters: tuple[FittedParameter, ...]
    #: Zeros of the trials, where ``per_trial`` asked for some.
    trial_zeros: tuple[TrialZero, ...]
    #: Correlations of the fitted ones, in their order; nan with as many parameters as data.
    correlations: Floats
    residuals: Residuals
    #: Misfit of the force before the fit, N.
    force_rms_before_n: float
    #: And after it.
    force_rms_n: float
    #: Misfit of the pressure rise before the fit, kPa.
    pressure_rise_rms_before_kpa: float
    #: And after it.
    pressure_rise_rms_kpa: float
    #: Noise of the force that the fit leaves: the part of every reading, N, and percent of reading.
    force_noise: tuple[float, float]
    #: Noise of the pressure rise: kPa, and percent of reading.
    pressure_rise_noise: tuple[float, float]
    #: What the tool notes, a line each: units that were read, what the data do not tell, hysteresis, cross-validation.
    notes: tuple[str, ...]

    def __getitem__(self, name: str) -> FittedParameter:
        """The parameter of that name."""
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)


def _text(data: Mapping[str, ArrayLike]) -> bytes:
    """Arrays as the CSV file that the tool reads."""
    unknown = [name for name in data if name not in (*QUANTITIES, "trial", "direction")]
    if unknown:
        raise FitError(f"data has {unknown[0]!r}: must be of {', '.join(QUANTITIES)}, trial, direction")
    arrays = {name: np.atleast_1d(np.asarray(values)) for name, values in data.items()}
    lengths = {name: len(values) for name, values in arrays.items()}
    if len(set(lengths.values())) > 1:
        counts = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise FitError(f"the arrays of data have different lengths ({counts}): give as many numbers of each")
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(arrays)
    writer.writerows(zip(*(values.tolist() for values in arrays.values()), strict=True))
    return text.getvalue().encode()


def fit(
    design: DesignLike,
    data: DataLike,
    *,
    parameters: Iterable[str] = (),
    per_trial: Iterable[str] = (),
    columns_of: Mapping[str, str | int] | None = None,
    only: Mapping[str, object] | None = None,
    direction: str | None = None,
) -> Fit:
    """Calibrates a design to bench data, as ``designer fit``: robust least squares, and what the data do not tell is held.

    Args:
        data: two or three of ``indentation_mm`` (from first touch on, taken as exact), ``force_n``, ``pressure_rise_kpa``, and
            ``trial`` and ``direction`` (loading, unloading): a CSV file as a bench writes it, or a dict of arrays.
        parameters: of material, pole-stretch, compliance, pressure-gain, thickness, indentation-offset, pressure-offset,
            force-offset; the first three where it is left out.
        per_trial: zeros that each trial has of its own, of indentation-offset (first touch is then found in the rows before it),
            force-offset, pressure-offset.
        columns_of: which column of the file holds a quantity, by its name or its number from 1 on.
        only: only rows whose column has this value.
        direction: ``"loading"`` or ``"unloading"``: only rows of this direction.

    Raises:
        DesignError: the design cannot be.
        FitError: data that cannot be read, or that no fit comes near.
    """
    design = design_of(design)
    if isinstance(data, Mapping):
        name, raw = "data", _text(data)
    else:
        name = os.fspath(data)
        try:
            with open(data, "rb") as file:
                raw = file.read()
        except OSError as error:
            raise FitError(f"{name}: the data cannot be read: {error.strerror}") from error
    pairs = [(key, str(value)) for key, value in (columns_of or {}).items()]
    rows = [(key, str(value)) for key, value in (only or {}).items()]
    if isinstance(parameters, str):
        parameters = [parameters]
    if isinstance(per_trial, str):
        per_trial = [per_trial]
    text, estimates, zeros, correlations, left, misfits, noise, notes = _fingertip.fit(
        design.text, design.name, raw, name, list(parameters), list(per_trial), pairs, rows, direction
    )
    table, forces, outliers, trials = left
    line, depth, measured, before, fitted, standardised = columns(table, 6)
    residuals = Residuals(
        tuple("force_n" if is_force else "pressure_rise_kpa" for is_force in forces),
        line,
        tuple(trials),
        depth,
        measured,
        before,
        fitted,
        standardised,
        np.array(outliers, dtype=np.bool_),
    )
    force_before, force_after, rise_before, rise_after = misfits
    matrix = np.frombuffer(correlations, dtype=np.float64)
    size = int(np.sqrt(len(matrix)))
    return Fit(
        Design.from_text(text, f"{design.name} (calibrated)"),
        tuple(FittedParameter(*estimate) for estimate in estimates),
        tuple(TrialZero(*zero) for zero in zeros),
        matrix.reshape(size, size).copy(),
        residuals,
        force_before,
        force_after,
        rise_before,
        rise_after,
        (noise[0], noise[1]),
        (noise[2], noise[3]),
        tuple(notes),
    )
