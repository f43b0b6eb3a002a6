"""Rigid boxes in the report."""

from __future__ import annotations

from validation.report.chapters.hooks import PageHooks


class HOOKS(PageHooks):
    """Boxes, whose programs choose their steps for themselves."""

    chooses_steps = False
