"""What a scene of a pendulum is."""

from typing import ClassVar

from validation.models.pendulum.tables import PendulumSection

from validation.scenes.kinds import Kind


class Pendulum(Kind):
    """A mass on a rod that swings."""

    name = "pendulum"
    words = "a pendulum"
    feature = "pendulum"  # by which solvers say that they take it
    tables: ClassVar = {"pendulum": PendulumSection}
    refuses = ("damping", "fem")

    def run(self, table):
        """Return what runs a scene that does not say."""
        return {"solvers": ["dda"], "columns": ["rotation"]}


KIND = Pendulum
