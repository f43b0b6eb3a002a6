"""What follows from a scene's parameters before anything runs: its kind's numbers, over the cases of a sweep."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np

from validation.advice.coarse import AGREEMENT, SAMPLED, coarse_alarms
from validation.advice.hooks import AdviceHooks
from validation.report.scene.hooks import Number, ShowingHooks
from validation.scenes.scene import Scene

MOST_CASES = 200  # of a sweep that are looked at, evenly taken
OF_STEPS = {  # the alarms of a run, without their numbers, by which the cases of a sweep would differ
    AGREEMENT: "the step damps more than a third of the first mode, or of the input, away in a period",
    SAMPLED: "fewer than two steps per period of the first mode, or of the input: no history can show it",
}
UNSTABLE = "dt is beyond the stability limit: the solution grows without bound"


Ranges = dict[str, tuple[float, float, Number]]  # name -> least, greatest, and the number of one case


def cases(scene: Scene) -> list[Scene]:
    """Return the cases of a scene; of very many `MOST_CASES`, with first and last."""
    every = scene.expand()
    if len(every) <= MOST_CASES:
        return list(every)
    return [every[i] for i in np.linspace(0, len(every) - 1, MOST_CASES).round().astype(int)]


def ranges(numbers_by_case: Sequence[Sequence[Number]]) -> Ranges:
    """Return each number's range over cases, in the order of the case with most of them."""
    ranges_by_name: Ranges = {}
    for numbers in sorted(numbers_by_case, key=len, reverse=True):
        for number in numbers:
            low, high, first = ranges_by_name.get(number.name, (number.value, number.value, number))
            ranges_by_name[number.name] = (min(low, number.value), max(high, number.value), first)
    return ranges_by_name


def numbers(scene: Scene) -> list[Number]:
    """Return the derived numbers of a case that are finite."""
    derived = itertools.chain(ShowingHooks.of(scene).numbers(scene), _steps(scene))
    return [number for number in derived if math.isfinite(number.value)]


def remarks(scene: Scene, derived: Sequence[Number]) -> list[str]:
    """Return in words the limits that a case with these numbers is beyond."""
    values = {number.name: number.value for number in derived}
    hooks = ShowingHooks.of(scene)
    of_step = (OF_STEPS[alarm.kind] for alarm in coarse_alarms(scene, values.get(hooks.first_mode)))
    of_contacts = (alarm.sentence for alarm in AdviceHooks.of(scene).alarms(scene))
    unstable = [UNSTABLE] if scene.time.step > values.get("dt stable", math.inf) * (1 + 1e-12) else []
    return [*of_step, *unstable, *hooks.remarks(scene, values), *of_contacts]


def _steps(scene: Scene) -> Iterator[Number]:
    t = scene.time
    yield Number("n dt", t.duration, "s", "simulated time")
    if 0 < t.discount < 1:
        yield Number("-ln gg/dt", -math.log(t.discount) / t.step, "1/s", "rate at which gg reduces velocity")
