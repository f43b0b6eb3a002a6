"""Which function writes the chapter of which study: that of its folder, or the one of a scene."""

from __future__ import annotations

from validation.report.blocks import Chapter
from validation.report.chapters.scene import scene_chapter
from validation.suite.folders import study_folders


def chapter_of(study: str) -> Chapter:
    """Return the function that writes a study's chapter, importing its module now."""
    folder = study_folders().get(study)
    module = None if folder is None else folder.module("chapter")
    chapter: Chapter = scene_chapter if module is None else module.chapter
    return chapter
