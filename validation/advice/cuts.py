"""How to cut a column for its wave, or a beam of glued blocks for its static answer: run by `dda`, and compared."""

from __future__ import annotations

import math
from typing import Any

from validation.advice.contact_page import elements, own
from validation.advice.goals import AVERAGE, Candidate, Recommendation, difference, recommendation
from validation.advice.wave_advice import advise_wave, advised_scene
from validation.errors import InputError
from validation.runs.history import DISPLACEMENT
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.solvers.registry import by_role, get_solver, solve
from validation.theory import columns

MOST_STEPS = 4000  # of a run that is compared
MOST_BLOCKS = 2000  # of a beam that is tried
ACROSS = (1, 2, 3, 4, 6, 8, 10, 12, 16, 24, 32)  # blocks over the shorter side of a beam
ELEMENTS = 8  # across the shorter side of a beam, of degree two


def of_column(scene: Scene, error: float, frequency: float | None) -> tuple[str, Recommendation]:
    """Return what the blocks and the step of a bonded column do to a wave, and which to take.

    Half of the error is left to the amplitude of the wave, half to its phase: a wave that is late by a share of its
    period is off by 2 pi of that. What is advised is run under the scene's own input.

    Raises
    ------
    InputError
        No blocks and step let the wave arrive, or nothing answers exactly.
    """
    if scene.column is None:
        raise InputError("needs a column", source=scene.name)
    if frequency is None and scene.stated_input is not None:
        frequency = scene.stated_input.frequency
    if frequency is None:
        first = columns.first_frequency(scene.column)
        if first is None:
            raise InputError("must be given: the wave's", source=scene.name, field="--frequency", value="nothing")
        frequency = first / (2 * math.pi)
    advice = advise_wave(scene, frequency, error / 2, None, error / (4 * math.pi))
    if advice.advised is None:
        raise InputError(advice.advice, source=scene.name)
    settings: dict[str, Any] = {"time.step": advice.advised.step}
    layers = advised_scene(scene, advice.blocks).column
    if layers is not None:
        settings["column.layer"] = [layer.model_dump(exclude_defaults=True) for layer in layers.layer]
    steps = min(MOST_STEPS, math.ceil(scene.time.duration / advice.advised.step))
    case = scene.with_values(settings | {"time.steps": steps, "run.columns": [DISPLACEMENT]})
    truths = [truth for truth in by_role(Role.TRUTH) if get_solver(truth).refusal(case) is None]
    name = truths[0] if truths else elements()
    exact = case if truths else case.with_values(AVERAGE)
    history = solve(case, own()).history
    reference = solve(exact, name).history
    if history is None or reference is None:
        raise InputError("has no motion to compare with", source=scene.name)
    displacement_error = difference(history, reference, DISPLACEMENT)
    condition = f"a wave of {frequency:.4g} Hz over {advice.distance:.4g} m, judged under the scene's own input"
    candidate = Candidate(settings, steps, displacement_error, None)
    offer = recommendation(scene, "wave", condition, candidate, error, (name, 0.0), steps * advice.advised.step)
    return advice.sentence, offer


def of_beam(scene: Scene, error: float) -> tuple[str, Recommendation]:
    """Return the static error of the present blocks of a beam, and into how many to cut it.

    Raises
    ------
    InputError
        The blocks are stated one by one.
    """
    plane = scene.plane
    if plane is None or plane.subdivide is None or plane.width is None or plane.height is None:
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
            tried.append(Candidate(settings, scene.time.steps, displacement_error, None))
            if displacement_error <= error:
                break
        if tried[-1].error <= error:
            break
    candidate = min(tried, key=lambda candidate: candidate.error)
    cut = " x ".join(map(str, plane.subdivide))
    sentence = f"Its {cut} {plane.pattern} are off by {100 * present:.3g} % of the displacement at rest."
    condition = f"displacement at rest of {candidate.settings['plane.pattern']} on the glue of the scene"
    reference = ("static elements", abs(coarse / fine - 1))
    return sentence, recommendation(scene, "static", condition, candidate, error, reference, scene.time.duration)
