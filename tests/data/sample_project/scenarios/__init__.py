"""This project's own package of that name: its one table."""

from truebreak.scenarios import Circle, Scene

TABLE = Scene(
    [Circle(0, 0, vx=1, id="light"), Circle(5, "1/2", m=3, id="heavy"), Circle(10, 1, id="last")], name="table"
)
