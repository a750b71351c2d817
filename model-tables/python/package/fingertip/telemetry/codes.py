"""Codes of the protocol and their words (src/link/PROTOCOL.md)."""

from __future__ import annotations

import enum

__all__ = ["FAULT_WORDS", "WARNING_WORDS", "CommandKind", "Fault", "LastRun", "Outcome", "ResetCause", "Stored", "Touch", "Warnings"]


class Warnings(enum.Flag, boundary=enum.STRICT):
    """What qualifies the values of a reading; none set: it is ok."""

    NONE = 0
    #: Beyond the range of tables or transducer: force and indentation are lower bounds.
    SATURATED = 1 << 0
    #: The zero was not verified untouched: all values may be offset.
    ZERO_UNVERIFIED = 1 << 1
    #: Below the zero by more than noise: force and indentation are 0.
    BELOW_ZERO = 1 << 2
    #: The rest pressure fell for a minute: force and indentation are for more liquid than there is.
    LEAK_SUSPECTED = 1 << 3
    #: Softer than the model at a known indentation.
    BUBBLE_SUSPECTED = 1 << 4
    #: A stored calibration was refused.
    CALIBRATION_REFUSED = 1 << 5
    #: The zero may be off by more than six noise floors; the standard deviations allow for it.
    ZERO_AGED = 1 << 6
    #: The transducer's temperature changed in contact.
    TEMPERATURE = 1 << 7
    #: The crystal failed: times are a percent off.
    CLOCK = 1 << 8
    #: The wall recovers from a press: force 0 within its standard deviation, the indentation an upper bound.
    RECOVERING = 1 << 9
    #: Reset or lost samples in a grasp of a relaxing wall.
    PAST_UNKNOWN = 1 << 10
    #: The pressure hums: the standard deviations allow for it.
    NOISY = 1 << 14


#: The protocol's word for each warning.
WARNING_WORDS = {warning: warning.name.lower().replace("_", " ") for warning in Warnings if warning.name}


class Fault(enum.IntEnum):
    """Why there is no reading."""

    SENSOR_OPEN = 1
    SENSOR_SHORT = 2
    ZEROING = 3
    SETTLING = 4
    SAMPLES_LOST = 5
    CONVERTER_STALLED = 6
    STUCK = 7
    JUMP = 8
    RESET_LOOP = 9
    SENSOR_SUPPLY = 10
    CHANNEL_IDENTITY = 11
    SENSOR_ABSENT = 16
    BUS_FAULT = 17
    WRONG_SENSOR = 18
    SENSOR_CALIBRATION = 19
    SENSOR_BUSY = 20
    SENSOR_MEMORY = 21
    SENSOR_SATURATED = 22
    SENSOR_RESET = 23
    SENSOR_IMPLAUSIBLE = 24


#: The protocol's word for each fault.
FAULT_WORDS = {fault: fault.name.lower().replace("_", " ") for fault in Fault}


class Touch(enum.IntEnum):
    """Whether something touches."""

    UNKNOWN = 0
    UNTOUCHED = 1
    TOUCHED = 2


class ResetCause(enum.IntEnum):
    """Why the chip was reset last."""

    UNKNOWN = 0
    POWER_ON = 1
    PIN = 2
    SOFTWARE = 3
    WATCHDOG = 4
    BROWN_OUT = 5
    LOW_POWER = 6


class Stored(enum.IntEnum):
    """The stored calibration."""

    NONE = 0
    IN_USE = 1
    OTHER_DESIGN = 2
    DAMAGED = 3
    UNREADABLE = 4


class LastRun(enum.IntEnum):
    """What ended the run before."""

    NOTHING_KNOWN = 0
    LATE_TASK = 1
    PANIC = 2
    HARD_FAULT = 3
    HANG = 4
    NON_MASKABLE_INTERRUPT = 5
    STACK_OVERFLOW = 6


class CommandKind(enum.IntEnum):
    """What a board can be told."""

    TARE = 0x81
    UNDO = 0x82
    SAVE = 0x83
    INFO = 0x84
    SELF_TEST = 0x85
    RATE = 0x86
    FORGET = 0x87
    OBJECT = 0x88
    INDENTATION = 0x89
    AIR = 0x8A
    ARM = 0x90
    BEGIN = 0x91
    CHUNK = 0x92
    VERIFY = 0x93
    ACTIVATE = 0x94
    ROLL_BACK = 0x95
    READ_BACK = 0x96

    @property
    def word(self) -> str:
        """Its name in lower case, as ``"self-test"``."""
        return self.name.lower().replace("_", "-")


class Outcome(enum.IntEnum):
    """What came of a command."""

    DONE = 0
    TOUCHED = 1
    RESTLESS = 2
    OUT_OF_BOUNDS = 3
    NO_READING = 4
    BUSY = 5
    NOTHING_TO_UNDO = 6
    ZERO_UNVERIFIED = 7
    MEMORY_FAILED = 8
    NO_SUCH_OBJECT = 9
    NO_SUCH_TIP = 10
    OUT_OF_ORDER = 11
    BLOCK_REFUSED = 12
    OTHER_DESIGN = 13
    NOT_IN_THIS_IMAGE = 14
    NOT_ARMED = 15
    SAVED_TOO_OFTEN = 16

    @property
    def word(self) -> str:
        """Its name in lower case, as ``"out of bounds"``."""
        return self.name.lower().replace("_", " ")
