"""Readings as ROS 2 messages: the fields of ``geometry_msgs/WrenchStamped`` and ``sensor_msgs/FluidPressure``, as ``dict``.

A node sets them with ``rosidl_runtime_py.set_message.set_message_fields(message, fields)``; nothing of ROS is needed here.

| field | from |
|---|---|
| ``header.stamp`` | the board's time of the samples, moved to the host's clock by ``offset_ns`` |
| ``header.frame_id`` | ``frame_id``, a frame whose z axis points out of the fingertip: for a tip of a hand its name |
| ``wrench.force.z`` | minus the force: what is touched pushes into the fingertip; N |
| ``fluid_pressure`` | ``rest_pa`` plus the pressure rise: the message is absolute, Pa |
| ``variance`` | the square of the reading's standard deviation of the rise, Pa^2 |

A fault makes no message, and so does a reading that :attr:`Warnings.SATURATED` qualifies as a bound for the wrench: a node that hears
nothing knows nothing.
"""

from __future__ import annotations

from typing import Any

from .codes import Warnings
from .frames import Frame, Reading

__all__ = ["fluid_pressure", "wrench_stamped"]


def _header(frame: Frame, frame_id: str, offset_ns: int) -> dict[str, Any]:
    seconds, rest = divmod(frame.time_us * 1000 + offset_ns, 1_000_000_000)
    return {"stamp": {"sec": seconds, "nanosec": rest}, "frame_id": frame_id}


def wrench_stamped(frame: Frame, frame_id: str, *, offset_ns: int = 0) -> dict[str, Any] | None:
    """The fields of a ``geometry_msgs/WrenchStamped``; ``None`` for what is no reading, or only a lower bound.

    Args:
        frame: a frame of the board.
        frame_id: the frame of the fingertip.
        offset_ns: the host's clock at the board's zero, ns since 1970.
    """
    if not isinstance(frame, Reading) or Warnings.SATURATED in frame.warnings:
        return None
    nothing = {"x": 0.0, "y": 0.0, "z": 0.0}
    return {
        "header": _header(frame, frame_id, offset_ns),
        "wrench": {"force": {**nothing, "z": -frame.force_n}, "torque": dict(nothing)},
    }


def fluid_pressure(frame: Frame, frame_id: str, *, rest_pa: float, offset_ns: int = 0) -> dict[str, Any] | None:
    """The fields of a ``sensor_msgs/FluidPressure``; ``None`` for what is no reading.

    Args:
        frame: a frame of the board.
        frame_id: the frame of the fingertip.
        rest_pa: absolute pressure in the untouched fingertip, Pa.
        offset_ns: the host's clock at the board's zero, ns since 1970.
    """
    if not isinstance(frame, Reading):
        return None
    return {
        "header": _header(frame, frame_id, offset_ns),
        "fluid_pressure": rest_pa + frame.pressure_rise_pa,
        "variance": frame.pressure_rise_sigma_pa**2,
    }
