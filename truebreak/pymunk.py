"""For users of pymunk: `record` logs a live space, for `truebreak diff`.

>>> from truebreak.pymunk import record
>>> record.__name__
'record'
"""

from __future__ import annotations

from .compare.logdiff.pymunk_record import PymunkRecording, record

__all__ = ["PymunkRecording", "record"]
