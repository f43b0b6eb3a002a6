"""What the pages of the report ask of the kind of a scene."""

from __future__ import annotations

from validation.report.chapters.data import CaseGroup, CaseResults
from validation.scenes.kinds import Hooks


class PageHooks(Hooks):
    """How a kind of scene is told in the report."""

    module = "pages"
    chooses_steps: bool = True  # whether step and discount are the scene's, and not each program's

    def springs(self, group: CaseGroup) -> str:
        """Return what the springs of the cases are and do; nothing where there is nothing to tell."""
        return ""

    def first_frequency(self, case: CaseResults) -> float | None:
        """Return the first natural frequency of DDA's model [rad/s], of a row or of a closed form."""
        return case.number("dda", "mode1.frequency")
