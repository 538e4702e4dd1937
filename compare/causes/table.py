"""The table of causes: what may part two histories, or stop an engine, and where each is tried."""

from __future__ import annotations

from dataclasses import dataclass

NO_CAUSE = "The histories differ"
"""The sentence of a report where no cause is told, or none that has a sentence of its own."""


@dataclass(frozen=True)
class Cause:
    """One class of causes.

    Attributes:
        text: what a person reads.
        experiment: where two histories part, the function that tries it, `module:function` of this folder: it takes the
            `Laboratory` and what was found `SoFar`, and gives rows. None: it is not tried there.
        stop: the same where an engine stops, of `Stopped` and the rows so far.
        rounding: whether it is floating-point error; None: where the engine takes no time steps.
        head: the sentence of a report for a history that it changed, where it is not.
        settings: whether it tries a series of settings, and says which of them was enough.
    """

    text: str
    experiment: str | None = None
    stop: str | None = None
    rounding: bool | None = False
    head: str = NO_CAUSE
    settings: bool = False


TUNNELS = "The time step let circles pass through each other"

CAUSES: dict[str, Cause] = {
    "LAW": Cause("law not kept", "experiments.law:law", head="The engine does not keep the law"),
    "INPUT": Cause("input rounding", "experiments.input_rounding:input_rounding", rounding=True),
    "STEP": Cause("time step", "experiments.step:step", head="The time step changed what happened", settings=True),
    "TUNNELLING": Cause("tunnelling", "experiments.tunnelling:tunnelling", head=TUNNELS),
    "ITERATIONS": Cause(
        "solver iterations",
        "experiments.iterations:iterations",
        head="The solver's iterations changed what happened",
        settings=True,
    ),
    "ARITHMETIC": Cause("arithmetic rounding", "experiments.arithmetic:arithmetic", rounding=True),
    "TOGETHER": Cause("input and arithmetic rounding together", "experiments.together:together", rounding=True),
    "UNABLE": Cause("scene not possible in this engine", stop="stops.unable:unable"),
    "BUDGET": Cause("budget", stop="stops.budget:budget"),
    "WIDTH": Cause("enclosure width", stop="stops.width:width"),
    "TIE": Cause("tie", "experiments.tie:tie", "stops.tied:tied", rounding=None, head="A tie was resolved differently"),
    "ZERO": Cause("exact zero", stop="stops.zero:zero"),
    "MODEL": Cause("model", "experiments.model:model", head="The engine follows another law"),
    "UNKNOWN": Cause("not determined", rounding=None),
}
"""Every cause by its name in `CauseName`, in the order in which they are tried. A new one is its own file, and one line
here."""
