"""The table of a pendulum."""

from typing import Annotated

from validation.scenes.keys import Key, Section
from validation.scenes.tables import Positive


class PendulumSection(Section):
    """A mass on a rod."""

    length: Annotated[Positive, Key("m", "of the rod")]
    gravity: Annotated[Positive, Key("m/s2", "downwards", "g")] = 9.81
