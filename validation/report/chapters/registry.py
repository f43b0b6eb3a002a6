"""Which chapter a study has: what its folder describes or computes, or the one of a scene."""

from __future__ import annotations

import functools

from validation.report.blocks import Chapter
from validation.report.chapters.scene import scene_chapter
from validation.report.chapters.written import written_chapter
from validation.suite.folders import folder_of


def chapter_of(study: str) -> Chapter:
    """Return the function that writes a study's chapter, importing its module now."""
    folder = folder_of(study)
    if folder is None:
        return scene_chapter
    module = folder.module("chapter")
    if hasattr(module, "chapter"):
        chapter: Chapter = module.chapter
        return chapter
    description = folder.path / "chapter.toml"
    if not description.exists():
        return scene_chapter
    return functools.partial(written_chapter, description=description, module=module)
