"""A column in the report."""

from __future__ import annotations

from validation.models.column.tables import ColumnSection
from validation.report.chapters.data import CaseGroup, CaseResults
from validation.report.chapters.hooks import PageHooks
from validation.runs.numbers import short
from validation.theory import columns


class HOOKS(PageHooks):
    """Layers of blocks."""

    def springs(self, group: CaseGroup) -> str:
        """Return the springs between the blocks, and their law."""
        column = group.cases[0].scene.table(ColumnSection)
        stiffness = column.stiffness or column.glue
        return "" if stiffness is None else f"{short(stiffness)} Pa/m between the blocks, {column.law}."

    def first_frequency(self, case: CaseResults) -> float | None:
        """Return the closed form."""
        return columns.first_frequency(case.scene.table(ColumnSection))
