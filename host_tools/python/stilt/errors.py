"""Exceptions of this package; the text of each is one sentence for the user."""


class RecordError(ValueError):
    """A file is no record, is cut off, or cannot be read by this release."""


class RobotError(RuntimeError):
    """A robot cannot be reached, is silent, or has a fault."""


class Refused(RobotError):
    """The robot or its monitor refused a command; the text is its reason."""
