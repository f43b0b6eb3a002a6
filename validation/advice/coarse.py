"""Alarms of a step that is too long for the motion, from the scheme's roots alone: no solver is run for them.

Programs that take the same steps agree because both are damped alike. What the discount and damping tables take is
meant, and counts for nothing; where they take as much in a period, the motion is to come to rest, and there is nothing
to warn of. A block that slides or turns as a whole is left to the alarms of friction and landings.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from validation.advice.alarm import Alarm, alarm
from validation.advice.hooks import AdviceHooks
from validation.runs.numbers import share_text
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.theory.stepping import Stepping

AGREEMENT = "agreement by damping"
SAMPLED = "fewer than two steps per period"
KINDS = (AGREEMENT, SAMPLED)
REMOVED = 1 / 3  # of the amplitude in a period, by a damping ratio of 6.4 %: more than rock and structures are given
FOLLOWED = 0.01  # damping ratio of the step that is named instead: a tenth of the amplitude is left after 37 periods
SHOWN = 20  # steps a period that are named where fewer than two are taken
RESOLVED = 1e-3  # w dt at which every scheme has less than `FOLLOWED`
TURNS = 50  # of w dt between which that step is looked for


@dataclass(frozen=True)
class Removal:
    """What a step leaves of a motion."""

    omega_dt: float  # w dt [1]
    by_scheme: float  # share of the amplitude that the scheme takes in a period, or in a shorter run [1]
    by_damping: float  # the same of discount and damping tables [1]


def coarse_alarms(scene: Scene, frequency: float | None = None, agreement: Callable[[], str] = str) -> Iterator[Alarm]:
    """Yield the alarms of a step that is too long for what a scene's motion is made of, of its slowest part only.

    `frequency` is that of the first mode as a run has it [rad/s], looked for if absent; `agreement` says which programs
    agree, and how well, and is called where there is an alarm.
    """
    for motion in AdviceHooks.of(scene).motions(scene, frequency):
        removal = removal_of(scene, motion.frequency)
        if removal.by_damping >= REMOVED:
            continue
        values = {"frequency": motion.frequency, "omega_dt": removal.omega_dt, "removed": removal.by_scheme}
        words = {"what": motion.name, "w": motion.frequency}
        damps = removal.by_scheme >= REMOVED
        if damps:
            scheme = _scheme(scene)
            xi = scheme.damping_ratio(removal.omega_dt)
            ratio = f" at {share_text(xi)} of critical" if math.isfinite(xi) else ""
            step = _followed(scheme, removal.omega_dt) * scene.time.step
            span = "two steps" if removal.omega_dt > math.pi else "a period"
            words |= {"ratio": ratio, "percent": 100 * removal.by_scheme, "span": span}
            why = _because(agreement(), "both are damped out")
            yield alarm(AGREEMENT, scene.name, values | {"damping": xi}, step=step, agreement=why, **words)
        if removal.omega_dt > math.pi:
            why = "" if damps else _because(agreement(), "both take the same steps")
            step = 2 * math.pi / motion.frequency / SHOWN
            steps = 2 * math.pi / removal.omega_dt
            yield alarm(SAMPLED, scene.name, values, steps=steps, step=step, agreement=why, **words)
        if damps or removal.omega_dt > math.pi:
            return


def _because(agreement: str, why: str) -> str:
    return f": {agreement} because {why}" if agreement else ""


def removal_of(scene: Scene, frequency: float) -> Removal:
    """Return what the step of a scene takes of a motion of a frequency [rad/s]."""
    t = scene.time
    omega_dt = frequency * t.step
    steps = min(max(2 * math.pi / omega_dt, 2.0), t.steps)  # two at least: a history shows no swing in fewer
    pair = _scheme(scene).roots(omega_dt)[:2]
    rate = scene.damping.mass + scene.damping.stiffness * frequency**2
    damped = math.sqrt(t.discount) * math.exp(-rate * t.step / 2)
    return Removal(omega_dt, 1 - min(float(max(abs(pair))), 1.0) ** steps, 1 - damped**steps)


def _scheme(scene: Scene) -> Stepping:
    """Return the scheme of a scene without its discount."""
    return replace(Stepping.of(scene), gg=1.0, rate=None)


@functools.lru_cache(maxsize=256)
def _followed(stepping: Stepping, beyond: float) -> float:
    """Return the step, over the present one of w dt = `beyond`, up to which a scheme damps less than `FOLLOWED`."""
    from scipy.optimize import brentq

    def excess(omega_dt: float) -> float:
        return stepping.damping_ratio(omega_dt) - FOLLOWED

    turns = np.geomspace(RESOLVED, beyond, TURNS)
    first = next((i for i, turn in enumerate(turns) if excess(turn) >= 0), 0)
    return brentq(excess, turns[first - 1], turns[first], rtol=1e-6) / beyond if first else 1.0


def closed(scene: Scene) -> Scene:
    """Return a scene whose contact stays closed: its springs locked, of a rigid stop as stiff as rounding allows.

    Its block stands still and upright, as one on such a contact does.
    """
    if features.linear(scene):
        return scene
    if scene.block.velocity or scene.block.tilt:
        scene = scene.with_values({"block.velocity": 0.0, "block.tilt": 0.0})
    contact = type(scene.contact)(stiffness=min(scene.contact.stiffness, 1e6 * scene.block.young))
    run = scene.run.model_copy(update={"geometry": "small", "rotation": "exact"})
    damping = scene.damping.model_copy(update={"kinetic": "constant"})
    return scene.model_copy(update={"stated_contact": contact, "run": run, "damping": damping})
