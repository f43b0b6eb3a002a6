"""The page of `advise` on blocks in the plane: how to cut a beam of glued ones, springs and step of moving ones."""

from __future__ import annotations

import math

from validation.advice.contact_page import elements, own
from validation.advice.goals import Candidate, Question, Recommendation, recommendation
from validation.advice.pages import Page, PageHooks, page_of_cut
from validation.advice.words import say
from validation.errors import InputError
from validation.models.plane.corner_springs import lines, moving_advice
from validation.models.plane.tables import PlaneSection
from validation.runs.history import DISPLACEMENT
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver

MOST_BLOCKS = 2000  # of a beam that is tried
ACROSS = (1, 2, 3, 4, 6, 8, 10, 12, 16, 24, 32)  # blocks over the shorter side of a beam
ELEMENTS = 8  # across the shorter side of a beam, of degree two


class HOOKS(PageHooks):
    """The blocks of a rectangle, or the contacts of blocks that move."""

    def page(self, scene: Scene, question: Question) -> Page:
        """Return the page of glued blocks, or of contacts of moving ones."""
        if scene.table(PlaneSection).is_glued:
            return page_of_cut(scene, question, *recommended_cut(scene, question.error))
        advice = moving_advice(scene, question.error, question.keep_springs)
        return advice.as_dict(), lines(scene, question.source, advice)


def recommended_cut(scene: Scene, error: float) -> tuple[str, Recommendation]:
    """Return the static error of the present blocks of a beam, and into how many to cut it.

    Blocks that are stated one by one are an `InputError`.
    """
    plane = scene.table(PlaneSection)
    if plane.subdivide is None or plane.width is None or plane.height is None:
        raise InputError("needs a rectangle that is cut (width, height, subdivide)", source=scene.name, field="plane")
    across = min(plane.width, plane.height)
    meshes = [scene.with_values({"fem.elements": count}) for count in (ELEMENTS // 2, ELEMENTS)]
    coarse, fine = (get_solver(elements()).static(mesh)[DISPLACEMENT] for mesh in meshes)
    present = abs(get_solver(own()).static(scene)[DISPLACEMENT] / fine - 1)
    tried: list[Candidate] = []
    for pattern in dict.fromkeys((plane.pattern, "triangles")):  # squares may lock where triangles converge
        for count in ACROSS:
            counts = [max(1, round(count * length / across)) for length in (plane.width, plane.height)]
            if math.prod(counts) * (2 if pattern == "triangles" else 1) > MOST_BLOCKS:
                break
            settings = {"plane.subdivide": counts, "plane.pattern": pattern, "time.step": scene.time.step}
            displacement_error = abs(get_solver(own()).static(scene.with_values(settings))[DISPLACEMENT] / fine - 1)
            tried.append(Candidate(settings, scene.time.steps, displacement_error))
            if displacement_error <= error:
                break
        if tried[-1].error <= error:
            break
    candidate = min(tried, key=lambda candidate: candidate.error)
    cut = " x ".join(map(str, plane.subdivide))
    sentence = say("present beam", present, cut=cut, pattern=plane.pattern)
    condition = say("beam condition", candidate.settings["plane.pattern"])
    reference = ("static elements", abs(coarse / fine - 1))
    return sentence, recommendation(scene, "static", condition, candidate, error, reference, scene.time.duration)
