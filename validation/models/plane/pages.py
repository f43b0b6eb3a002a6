"""Blocks in the plane in the report."""

from __future__ import annotations

from validation.models.plane.tables import PlaneSection
from validation.report.chapters.data import CaseGroup, CaseResults
from validation.report.chapters.hooks import PageHooks
from validation.runs.numbers import short


class HOOKS(PageHooks):
    """Glued blocks, which are read at rest."""

    def springs(self, group: CaseGroup) -> str:
        """Return the glue."""
        plane = group.cases[0].scene.table(PlaneSection)
        return f"Glue of {short(plane.glue)} E at each end of a shared edge."

    def first_frequency(self, case: CaseResults) -> None:
        """Return none: modes of glued blocks are compared, and nothing vibrates."""
