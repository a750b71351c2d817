"""What cannot be given: one line each, as the command line tool prints it."""

__all__ = [
    "DesignError",
    "FingertipError",
    "FitError",
    "ModelError",
    "SweepError",
    "TableError",
    "TelemetryError",
]


class FingertipError(Exception):
    """What was asked cannot be given."""


class DesignError(FingertipError):
    """A design or target that cannot be: the key, what was found, what is allowed."""


class ModelError(FingertipError):
    """No such state: what was asked, and the limit."""


class TableError(FingertipError):
    """No such tables, with the numbers."""


class FitError(FingertipError):
    """Data that cannot be read, or that no fit comes near: the row or the number, and the remedy."""


class SweepError(FingertipError):
    """A sweep that cannot run: its file, its folder, or its workers."""


class TelemetryError(FingertipError):
    """A board that cannot be read or commanded, with the remedy."""
