"""What cannot be given: one line each, as the command line tool prints it."""

__all__ = [
    "DesignError",
    "FingertipError",
    "ModelError",
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


class TelemetryError(FingertipError):
    """A board that cannot be read or commanded, with the remedy."""
