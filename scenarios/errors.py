"""The one error that bad input raises: what is wrong, where, and what to do about it."""

from __future__ import annotations

import sys
from types import FrameType
from typing import ClassVar


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


class endable:  # a function to whoever calls it
    """`with endable():` in the body `TimeIsUp` may come at any place, since the engine around it catches that.

    An alarm that rings elsewhere is let be, and rings again.

    Attributes:
        frames: whose bodies are at work now.
    """

    frames: ClassVar[set[FrameType]] = set()

    __slots__ = ("_frame",)

    def __enter__(self) -> None:
        self._frame = sys._getframe(1)  # pyright: ignore[reportPrivateUsage]
        endable.frames.add(self._frame)

    def __exit__(self, *_: object) -> None:
        endable.frames.discard(self._frame)
