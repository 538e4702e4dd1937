"""The one error that bad input raises: what is wrong, where, and what to do about it."""

from __future__ import annotations


class SceneError(ValueError):
    """A scene, a number or a setting that cannot be used.

    The message is one line that names the thing, its value and the remedy, fit to be shown to a person as it
    stands.

    >>> str(SceneError("circle 'b3': r is 0; a radius must be positive"))
    "circle 'b3': r is 0; a radius must be positive"
    """


class Disturbed(RuntimeError):
    """Something that exact numbers rest on was changed from outside while they were computed, and nothing is given
    back: flint's working precision, the rounding mode of doubles, or that these are kept near zero. The message says
    which, and what to do."""


class TimeIsUp(BaseException):
    """The seconds that the user allowed a whole run are over. Like an interruption, it may come anywhere; engines
    end their runs at what is whole by then."""
