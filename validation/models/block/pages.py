"""The page of `advise` on a block."""

from __future__ import annotations

from validation.advice.goals import Question
from validation.advice.overview import lines, overview
from validation.advice.pages import Page, PageHooks
from validation.scenes.scene import Scene


class HOOKS(PageHooks):
    """What settings do, and which to take for goals."""

    def page(self, scene: Scene, question: Question) -> Page:
        """Return facts on the present settings, and recommendations as they were run."""
        answer = overview(scene, question)
        return answer.as_dict(), lines(scene, question, answer)
