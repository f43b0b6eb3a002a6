"""The page of `dda-validate advise` on a scene, which a kind of scene makes of what is known of it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from validation.advice.goals import Question, Recommendation
from validation.advice.overview import Overview, recommended
from validation.errors import InputError
from validation.scenes.kinds import Hooks
from validation.scenes.scene import Scene

Page = tuple[dict[str, Any], Iterable[str]]  # plain data, and the lines that say it


class PageHooks(Hooks):
    """What is said of a scene, and what to take."""

    module = "pages"

    def page(self, scene: Scene, question: Question) -> Page:
        """Return the page on a scene without a sweep, or raise InputError where nothing is known of such a scene."""
        raise InputError("advise takes scenes of a block only", source=scene.name, value=scene.kind_in_words)


def page_of_cut(scene: Scene, question: Question, sentence: str, offer: Recommendation) -> Page:
    """Return the page on what is made of blocks: in words what the present ones do, and which to take."""
    answer = Overview(scene.name, question.error, (), None, (offer,), {})
    return {"sentence": sentence, **answer.as_dict()}, (sentence, "", *recommended(question, answer))
