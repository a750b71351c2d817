"""Sizing: designs for a wanted force over the indentation."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _fingertip
from ._design import to_toml
from .errors import DesignError
from .model import Design, Floats

#: A target: the path of its file, or a dict of its sections.
TargetLike = str | os.PathLike[str] | Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class SizedDesign:
    """A design that comes near the target and gets tables. Force, misfit and pressures are those of the model that its wall needs;
    stretches, tension and tolerances are the membrane's."""

    #: The design, with the accuracy that its tables reach.
    design: Design
    #: Its material's preset.
    material: str
    #: The model that its wall needs: ``"membrane"``, or ``"solid 2 x 60"`` with its elements.
    model: str
    #: Whether no membrane found is better in misfit, effect of making and peak pressure at once.
    non_dominated: bool
    #: ``"no"``: designs that wrinkle are left out.
    wrinkled: str
    #: Radial semi-axis of the mid-surface, mm.
    radial_semi_axis_mm: float
    #: Axial semi-axis of the mid-surface, mm.
    axial_semi_axis_mm: float
    #: Thickness of the undeformed wall, mm.
    thickness_mm: float
    #: Stretch of the pole at rest.
    pole_stretch: float
    #: Root mean square of the force's deviation from the target, percent.
    misfit_percent: float
    #: Gauge pressure at rest, kPa.
    rest_pressure_kpa: float
    #: Gauge pressure at the deepest indentation of the target, kPa.
    peak_pressure_kpa: float
    #: Largest principal stretch at rest and pressed.
    largest_stretch: float
    #: Largest ``I1 - 3`` over that up to which the material was tested; nan where that is not known.
    share_of_tested_strain: float
    #: Smallest tension, N/m.
    min_tension_n_per_m: float
    #: The end of the press, mm.
    limit_mm: float
    #: That over the deepest indentation of the target.
    limit_over_deepest: float
    #: Change of force, percent at most, for the tolerance in the radial semi-axis.
    force_percent_for_radial_tolerance: float
    #: The same for the axial semi-axis.
    force_percent_for_axial_tolerance: float
    #: The same for the wall.
    force_percent_for_thickness_tolerance: float
    #: Force at each indentation of the target, N.
    force_n: Floats


@dataclass(frozen=True, slots=True)
class Sizing:
    """What a sizing found."""

    #: Ranked, the best first; each gets tables.
    designs: tuple[SizedDesign, ...]
    #: Why designs are left out, a line each.
    left_out: tuple[str, ...]
    #: Indentations of the target, mm.
    indentation_mm: Floats
    #: Presses that the search solved.
    presses: int


def size(target: TargetLike, *, best: int = 8) -> Sizing:
    """Designs for a wanted force over the indentation, those that ``designer size`` gives and writes: each gets tables.

    Args:
        target: sections ``name``, ``[target]``, ``[bounds]``, ``[materials]``, ``[transducer]``, as
            ``model-tables/targets/human-fingertip.toml``.
        best: designs to give at most, 1 to 100.

    Raises:
        DesignError: the target cannot be, on one line.
        ModelError: no membrane within its bounds, or none that gets tables.
    """
    if not 1 <= best <= 100:
        raise DesignError(f"best is {best}: must be 1 to 100")
    if isinstance(target, Mapping):
        name, text = str(target.get("name", "target")), to_toml(target)
    else:
        name = os.fspath(target)
        try:
            with open(target, encoding="utf-8") as file:
                text = file.read()
        except OSError as error:
            raise DesignError(f"{name}: the target file cannot be read: {error.strerror}") from error
    rows, left_out, presses, indentations = _fingertip.size(text, name, best)
    designs = []
    for rank, (toml, material, model, front, wrinkled, numbers, forces) in enumerate(rows, 1):
        radial, axial, wall, stretch, misfit, at_rest, peak, largest, share, tension, limit, margin = numbers[:12]
        by_radial, by_axial, by_wall = numbers[12:]
        designs.append(
            SizedDesign(
                design=Design.from_text(toml, f"{name} ({rank})"),
                material=material,
                model=model,
                non_dominated=front,
                wrinkled=wrinkled,
                radial_semi_axis_mm=radial,
                axial_semi_axis_mm=axial,
                thickness_mm=wall,
                pole_stretch=stretch,
                misfit_percent=misfit,
                rest_pressure_kpa=at_rest,
                peak_pressure_kpa=peak,
                largest_stretch=largest,
                share_of_tested_strain=share,
                min_tension_n_per_m=tension,
                limit_mm=limit,
                limit_over_deepest=margin,
                force_percent_for_radial_tolerance=by_radial,
                force_percent_for_axial_tolerance=by_axial,
                force_percent_for_thickness_tolerance=by_wall,
                force_n=np.frombuffer(forces, dtype=np.float64).copy(),
            )
        )
    return Sizing(tuple(designs), tuple(left_out), np.array(indentations), presses)
