"""Which module writes the chapter of which study."""

from __future__ import annotations

import importlib

from validation.report.blocks import Chapter

DEFAULT_CHAPTER = "validation.report.chapters.scene:scene_chapter"
# study name to "module:function", in the order of the report; a study without an entry gets DEFAULT_CHAPTER
CHAPTERS: dict[str, str] = {
    "core": "validation.report.chapters.block.core:chapter",
    "work-precision": "validation.report.chapters.work:chapter",
    "two-codes": "validation.report.chapters.block.two_codes:chapter",
    "paper": "validation.report.chapters.paper:paper_chapter",
    "limits": "validation.report.chapters.limits.locking:chapter",
    "stiff-contact": "validation.report.chapters.limits.stiff_contact:contact_chapter",
    "stability-small": "validation.report.chapters.limits.stability:stability_chapter",
    "stability": "validation.report.chapters.limits.stability:stability_chapter",
    "subblocks": "validation.report.chapters.subblocks:chapter",
    "opening": DEFAULT_CHAPTER,
    "rebound": "validation.report.chapters.opened.rebound:chapter",
    "impacts": "validation.report.chapters.opened.impacts:chapter",
    "methods": "validation.report.chapters.methods:chapter",
    "slopes": "validation.report.chapters.slopes.sliding:chapter",
    "creep": "validation.report.chapters.slopes.creeping:chapter",
    "rocking": "validation.report.chapters.opened.turning:rocking_chapter",
    "toppling": "validation.report.chapters.opened.turning:toppling_chapter",
    "waves": "validation.report.chapters.waves:chapter",
    "columns": "validation.report.chapters.columns:chapter",
    "response": "validation.report.chapters.vibrations.response:chapter",
    "field": "validation.report.chapters.field:chapter",
}


def chapter_of(study: str) -> Chapter:
    """Return the function that writes a study's chapter, importing its module now."""
    module, _, name = CHAPTERS.get(study, DEFAULT_CHAPTER).partition(":")
    function: Chapter = getattr(importlib.import_module(module), name)
    return function
