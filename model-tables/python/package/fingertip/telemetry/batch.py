"""Readings and faults as numpy arrays."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from .frames import FaultReport, Frame, Reading

__all__ = ["Batch"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Batch:
    """Readings and faults, one an element; values of a fault are nan."""

    #: Time since the board's reset, s.
    time_s: Floats
    #: Sequence number of the frame.
    sequence: NDArray[np.uint16]
    #: Number of the tip.
    tip: NDArray[np.uint8]
    #: Reason of a fault (:class:`Fault`); 0 of a reading.
    fault: NDArray[np.uint8]
    #: Bits of :class:`Warnings`; 0: ok, or a fault.
    warnings: NDArray[np.uint32]
    #: :class:`Touch`; 0 of a fault.
    touch: NDArray[np.uint8]
    #: Pressure over that at rest, Pa.
    pressure_rise_pa: Floats
    #: Force, N.
    force_n: Floats
    #: Indentation, mm.
    indentation_mm: Floats
    #: Standard deviation of the pressure rise, Pa.
    pressure_rise_sigma_pa: Floats
    #: Standard deviation of the force, N.
    force_sigma_n: Floats
    #: Standard deviation of the indentation, mm.
    indentation_sigma_mm: Floats
    #: Force of the feedback actuator, N; nan of a design without one.
    feedback_force_n: Floats
    #: Its standard deviation, N.
    feedback_force_sigma_n: Floats

    @classmethod
    def of(cls, frames: Iterable[Frame]) -> Batch:
        """The readings and faults among frames, in their order."""
        kept = [frame for frame in frames if isinstance(frame, Reading | FaultReport)]
        values = np.full((8, len(kept)), np.nan)
        state = np.zeros((3, len(kept)), dtype=np.uint32)
        for place, frame in enumerate(kept):
            if isinstance(frame, FaultReport):
                state[0, place] = frame.reason
                continue
            state[1:, place] = frame.warnings.value, frame.touch
            numbers = (
                frame.pressure_rise_pa,
                frame.force_n,
                frame.indentation_mm,
                frame.pressure_rise_sigma_pa,
                frame.force_sigma_n,
                frame.indentation_sigma_mm,
                frame.feedback_force_n,
                frame.feedback_force_sigma_n,
            )
            # None is nan.
            values[:, place] = np.array(numbers, dtype=np.float64)
        return cls(
            1e-6 * np.array([frame.time_us for frame in kept], dtype=np.float64),
            np.array([frame.sequence for frame in kept], dtype=np.uint16),
            np.array([frame.tip for frame in kept], dtype=np.uint8),
            state[0].astype(np.uint8),
            state[1],
            state[2].astype(np.uint8),
            *values,
        )

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def is_ok(self) -> NDArray[np.bool_]:
        """Where there is a reading that no warning qualifies."""
        is_ok: NDArray[np.bool_] = (self.fault == 0) & (self.warnings == 0)
        return is_ok

    def of_tip(self, tip: int) -> Batch:
        """Those of one tip."""
        where = self.tip == tip
        return Batch(*(getattr(self, field.name)[where] for field in fields(self)))
