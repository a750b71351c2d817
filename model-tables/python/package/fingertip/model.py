"""Designs, states, presses in time, tables."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _fingertip
from ._design import merged, to_toml
from .errors import DesignError, FingertipError

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


class Design:
    """A checked design.

    Args:
        source: the path of a design file, a dict of its sections, or another design; left out, the sections are keywords.
        sections: sections and keys that are added to the source or replace its own, as ``membrane={"thickness_mm": 0.5}``.

    Raises:
        DesignError: a key or value that cannot be, on one line.
    """

    __slots__ = ("name", "text")

    #: What errors call it: the file, or the design's name.
    name: str
    #: The design as TOML.
    text: str

    def __init__(self, source: DesignLike | None = None, **sections: Any) -> None:
        if isinstance(source, Design):
            name, text = source.name, source.text
        elif isinstance(source, Mapping):
            name, text = str(source.get("name", "design")), to_toml(source)
        elif source is None:
            name, text = str(sections.get("name", "design")), ""
        else:
            name = os.fspath(source)
            try:
                with open(source, encoding="utf-8") as file:
                    text = file.read()
            except OSError as error:
                raise DesignError(f"{name}: the design file cannot be read: {error.strerror}") from error
        if sections:
            # A file that is no TOML gets the tool's line.
            if text:
                _fingertip.canonical(text, name)
            text = to_toml(merged(tomllib.loads(text), sections))
        _fingertip.canonical(text, name)
        self.name, self.text = name, text

    @classmethod
    def from_text(cls, text: str, name: str = "design") -> Design:
        """A design of TOML text; ``name`` is what errors call it."""
        _fingertip.canonical(text, name)
        design = cls.__new__(cls)
        design.name, design.text = name, text
        return design

    def canonical(self) -> str:
        """The design as TOML with every value written out, as its certificate's hash has it."""
        return _fingertip.canonical(self.text, self.name)

    def __repr__(self) -> str:
        return f"Design({self.name!r})"


DesignLike = Design | Mapping[str, Any] | str | os.PathLike[str]


@dataclass(frozen=True, slots=True)
class Rest:
    """A rest state and the limits of its press."""

    #: The model: ``"membrane"``, or ``"solid 2 x 60"`` with its elements.
    model: str
    #: Gauge pressure of the fluid, kPa.
    pressure_kpa: float
    #: Stretch of the pole; 1 is unstretched.
    pole_stretch: float
    #: Deformed radius of the equator, mm.
    equator_radius_mm: float
    #: Height over the base, mm.
    height_mm: float
    #: Volume of the fluid, mm^3.
    volume_mm3: float
    #: The deepest indentation that has a state, mm.
    max_indentation_mm: float
    #: What ends the press there, as ``"bulge-touches-base"``.
    ends_by: str


@dataclass(frozen=True, slots=True)
class States:
    """Pressed states, one an element, in the order asked."""

    #: The model: ``"membrane"``, or ``"solid 2 x 60"`` with its elements.
    model: str
    #: Indentation of the pole, mm.
    indentation_mm: Floats
    #: Gauge pressure of the fluid, kPa.
    pressure_kpa: Floats
    #: Pressure over that at rest, kPa.
    pressure_rise_kpa: Floats
    #: Force on the plate, N.
    force_n: Floats
    #: Radius of the contact, mm.
    contact_radius_mm: Floats
    #: Stretch of the pole.
    pole_stretch: Floats
    #: Smallest tension of the membrane, N/m; nan for a solid.
    min_tension_n_per_m: Floats
    #: ``"no"``, ``"wrinkled"`` or ``"slack"``; empty for a solid.
    wrinkled: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class History:
    """A press in time of a wall that relaxes, one instant an element."""

    #: Time, s.
    time_s: Floats
    #: Indentation of the pole from first touch, mm.
    indentation_mm: Floats
    #: Pressure over that of the untouched, recovered tip, kPa.
    pressure_rise_kpa: Floats
    #: Force on the plate, N.
    force_n: Floats
    #: How far the apex is below its place at rest, mm.
    apex_depression_mm: Floats
    #: Whether the plate touches.
    contact: Bools


@dataclass(frozen=True, slots=True)
class Tables:
    """The chip's tables of a design, with what holds of them on every input."""

    #: Bytes of the tables on the chip.
    size_bytes: int
    #: Inputs, each of which was checked.
    inputs: int
    #: Largest error of the force, percent of reading.
    force_error_percent: float
    #: Largest error of the indentation, percent of reading.
    indentation_error_percent: float
    #: Error of the model itself, percent of reading; nan where it is not known.
    model_error_percent: float
    #: Pressure rise at the end of the press, kPa.
    end_pressure_rise_kpa: float
    #: ``tables.bin`` of ``designer table``.
    binary: bytes
    #: ``certificate.toml``.
    certificate: str
    #: ``tables.rs``.
    rust_source: str
    #: ``tables.csv``.
    csv: str


@dataclass(frozen=True, slots=True)
class Estimates:
    """What the chip's tables say, bit for bit, one an element."""

    #: Pressure over that at rest, Pa.
    pressure_rise_pa: Floats
    #: Force on the plate, N.
    force_n: Floats
    #: Indentation of the pole, mm.
    indentation_mm: Floats
    #: Whether the pressure is beyond the tables: force and indentation are then lower bounds.
    saturated: Bools
    #: Force of the feedback actuator, N; None of a design whose actuator does not press, or that has none.
    feedback_force_n: Floats | None = None


def design_of(design: DesignLike) -> Design:
    """A checked design of what stands for one."""
    return design if isinstance(design, Design) else Design(design)


def _floats(values: ArrayLike, name: str) -> list[float]:
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise FingertipError(f"{name} holds what is no number: give finite numbers") from error
    if array.ndim > 1:
        raise FingertipError(f"{name} has {array.ndim} dimensions: give one number or a row of them")
    if not np.isfinite(array).all():
        raise FingertipError(f"{name} holds {array[~np.isfinite(array)].flat[0]}: give finite numbers")
    numbers: list[float] = np.atleast_1d(array).tolist()
    return numbers


def columns(raw: bytes, count: int) -> list[Floats]:
    """Columns of the compiled part, one after the other."""
    columns = np.frombuffer(raw, dtype=np.float64).reshape(count, -1).copy()
    return list(columns)


def rest(design: DesignLike) -> Rest:
    """The rest state (inflated, not pressed) and the limit of the press.

    Raises:
        DesignError: the design cannot be.
        ModelError: there is no rest state.
    """
    design = design_of(design)
    model, numbers, ends_by = _fingertip.rest(design.text, design.name)
    pressure, stretch, radius, height, volume, deepest = numbers
    return Rest(model, pressure, stretch, radius, height, volume, deepest, ends_by)


def solve(design: DesignLike, indentation_mm: ArrayLike) -> States:
    """Pressed states at indentations in mm, 0 up to :attr:`Rest.max_indentation_mm`.

    Raises:
        DesignError: the design cannot be.
        ModelError: an indentation beyond the limit, or a state that was not found.
    """
    design = design_of(design)
    model, raw, wrinkled = _fingertip.solve(design.text, design.name, _floats(indentation_mm, "indentation_mm"))
    depth, pressure, rise, force, radius, stretch, tension = columns(raw, 7)
    return States(model, depth, pressure, rise, force, radius, stretch, tension, tuple(wrinkled))


def history(
    design: DesignLike,
    time_s: ArrayLike,
    *,
    indentation_mm: ArrayLike | None = None,
    force_n: ArrayLike | None = None,
) -> History:
    """A press in time of a solid wall, driven by its indentation in mm or its force in N, which change evenly in between.

    Args:
        time_s: increasing instants; at the first the tip is untouched and recovered.

    Raises:
        DesignError: the design cannot be, or is a membrane.
        ModelError: an instant that was not found.
    """
    design = design_of(design)
    by_force = force_n is not None
    name, values = ("force_n", force_n) if by_force else ("indentation_mm", indentation_mm)
    if values is None or (by_force and indentation_mm is not None):
        raise FingertipError("a press in time is driven by indentation_mm or by force_n: give one of them")
    times = _floats(time_s, "time_s")
    driven = _floats(values, name)
    if len(times) != len(driven):
        raise FingertipError(f"time_s has {len(times)} numbers and {name} {len(driven)}: give as many")
    raw, contact = _fingertip.history(design.text, design.name, times, driven, by_force)
    depth, rise, force, apex = columns(raw, 4)
    return History(np.array(times), depth, rise, force, apex, np.array(contact, dtype=np.bool_))


def table(design: DesignLike, *, allow_worse: bool = False) -> Tables:
    """The tables of a design, certified on every input.

    Args:
        allow_worse: also where they do not reach the accuracy that the design asks.

    Raises:
        DesignError: the design cannot be.
        TableError: it has no tables, with the numbers.
    """
    design = design_of(design)
    binary, certificate, source, csv, size, inputs, numbers = _fingertip.table(design.text, design.name, allow_worse)
    force, indentation, own, rise = numbers
    return Tables(size, inputs, force, indentation, own, rise * 1e-3, binary, certificate, source, csv)


def estimate(design: DesignLike, pressure_rise_pa: ArrayLike, *, allow_worse: bool = False) -> Estimates:
    """What the chip's integer tables say at pressure rises in Pa, bit for bit; of a wall that relaxes, the settled one.

    Raises:
        DesignError: the design cannot be.
        TableError: it has no tables, or has tables of other objects (``[object]``).
    """
    design = design_of(design)
    rises = _floats(pressure_rise_pa, "pressure_rise_pa")
    raw, saturated = _fingertip.estimate(design.text, design.name, rises, allow_worse)
    outputs = len(raw) // (8 * len(rises)) if rises else 2
    force, depth, *feedback = columns(raw, outputs)
    return Estimates(np.array(rises), force, depth, np.array(saturated, dtype=np.bool_), feedback[0] if feedback else None)
