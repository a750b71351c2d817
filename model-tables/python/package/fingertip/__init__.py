"""The hyperelastic model of a fluid-filled fingertip, and its tables.

A design is a TOML file, a dict of the same sections and keys, or keywords. Every function takes any of the three::

    import fingertip

    fingertip.rest("model-tables/designs/paper-prestretched.toml").pressure_kpa
    softer = fingertip.Design("model-tables/designs/paper-prestretched.toml", membrane={"thickness_mm": 0.5})
    fingertip.solve(softer, [0.5, 1.0, 2.0]).force_n

Numbers are numpy arrays of 64-bit floats in the unit that their name ends with. What cannot be given is a
:class:`FingertipError` with the one line that the command line tool gives. Python's lock is let go while a design is solved, so
that threads solve side by side.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from .errors import DesignError, FingertipError, FitError, ModelError, SweepError, TableError, TelemetryError

if TYPE_CHECKING:
    from .calibration import Fit, FittedParameter, Residuals, TrialZero, fit
    from .model import Design, DesignLike, Estimates, History, Rest, States, Tables, estimate, history, rest, solve, table
    from .sizing import SizedDesign, Sizing, size

__all__ = [
    "Design",
    "DesignError",
    "DesignLike",
    "Estimates",
    "FingertipError",
    "Fit",
    "FitError",
    "FittedParameter",
    "History",
    "ModelError",
    "Residuals",
    "Rest",
    "SizedDesign",
    "Sizing",
    "States",
    "SweepError",
    "TableError",
    "Tables",
    "TelemetryError",
    "TrialZero",
    "estimate",
    "fit",
    "history",
    "rest",
    "size",
    "solve",
    "table",
]

# Where a name is. Loaded when it is first asked for: `fingertip.telemetry` needs the standard library alone, not numpy and the model.
_HOMES = {
    "calibration": ("Fit", "FittedParameter", "Residuals", "TrialZero", "fit"),
    "model": ("Design", "DesignLike", "Estimates", "History", "Rest", "States", "Tables", "estimate", "history", "rest", "solve", "table"),
    "sizing": ("SizedDesign", "Sizing", "size"),
}


def __getattr__(name: str) -> Any:
    for home, names in _HOMES.items():
        if name in names:
            value = getattr(importlib.import_module(f".{home}", __name__), name)
            globals()[name] = value
            return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
