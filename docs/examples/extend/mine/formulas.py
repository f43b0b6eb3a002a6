"""The bands of the study."""

from validation.suite.bands import near
from validation.theory.statics import static_displacement


def settled(case):
    """Return the band of the displacement at rest."""
    return near(static_displacement(case), 1e-12)
