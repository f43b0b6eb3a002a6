"""Alarms of a step that is too long for the motion, from the scheme's roots alone: no solver is run for them.

agreement by damping
    The scheme takes a third of the first mode, or of the wave that drives a column, within one period. Programs that
    take the same steps agree because both are damped alike.
fewer than two steps per period
    The first mode turns by more than pi in a step: no history shows it, whatever the scheme.

What the discount and damping tables take is meant, and counts for neither; where they take as much in a period,
the motion is to come to rest, and there is nothing to warn of. A block that slides or turns as a whole is left to the
alarms of friction and landings.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from validation.advice.alarm import Alarm, alarm
from validation.advice.spectra import dda_modes
from validation.errors import InputError
from validation.runs.numbers import share_text
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.theory import columns
from validation.theory.stepping import Stepping

AGREEMENT = "agreement by damping"
SAMPLED = "fewer than two steps per period"
KINDS = (AGREEMENT, SAMPLED)
REMOVED = 1 / 3  # of the amplitude in a period, by a damping ratio of 6.4 %: more than rock and structures are given
FOLLOWED = 0.01  # damping ratio of the step that is named instead: a tenth of the amplitude is left after 37 periods
SHOWN = 20  # steps a period that are named where fewer than two are taken
LONG_RAMP = 40.0  # w times the ramp: a load that rises so slowly moves the mode by 2 / 40 = 5 % of its static part
RESOLVED = 1e-3  # w dt at which every scheme has less than `FOLLOWED`
TURNS = 50  # of w dt between which that step is looked for
MOST_SUB_BLOCKS = 64  # whose modes are found here; those of more come from the run


@dataclass(frozen=True)
class Motion:
    """What a step must follow."""

    name: str
    frequency: float  # [rad/s]


@dataclass(frozen=True)
class Removal:
    """What a step leaves of a motion.

    Attributes
    ----------
    omega_dt
        w dt [1].
    by_scheme
        Share of the amplitude that the scheme takes within a period, or within the run where that is shorter [1].
    by_damping
        The same of discount and damping tables [1].
    """

    omega_dt: float
    by_scheme: float
    by_damping: float


def coarse_alarms(scene: Scene, frequency: float | None = None, agreement: Callable[[], str] = str) -> Iterator[Alarm]:
    """Yield the alarms of a step that is too long for what a scene's motion is made of, of its slowest part only.

    Parameters
    ----------
    scene
        A case.
    frequency
        Of the first mode as a run has it [rad/s]; looked for if absent.
    agreement
        Says which programs agree, and how well; called where there is an alarm.
    """
    for motion in motions(scene, frequency):
        removal = removal_of(scene, motion.frequency)
        if removal.by_damping >= REMOVED:
            continue
        values = {"frequency": motion.frequency, "omega_dt": removal.omega_dt, "removed": removal.by_scheme}
        words: dict[str, object] = {"what": motion.name, "w": motion.frequency}
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
    rate = 0.0
    if scene.kind.name == "block":
        rate = scene.damping.mass + scene.damping.stiffness * frequency**2
    damped = math.sqrt(t.discount) * math.exp(-rate * t.step / 2)
    greatest = min(float(max(abs(pair))), 1.0)
    return Removal(omega_dt, 1 - greatest**steps, 1 - damped**steps)


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
    return float(brentq(excess, turns[first - 1], turns[first], rtol=1e-6)) / beyond if first else 1.0


# ---- what must be followed -----------------------------------------------------------------------------------------


def motions(scene: Scene, frequency: float | None = None) -> Iterator[Motion]:
    """Yield what the motion of a scene is made of: the first mode, and the wave that drives a column."""
    if scene.kind.name == "block" and (_moves_as_a_whole(scene) or _is_driven_slowly(scene)):
        return
    if scene.kind.name in ("rigid", "plane"):  # no mode; and glued blocks, which are read at rest and not over time
        return
    first = first_frequency(scene) if frequency is None else frequency
    if first is not None and math.isfinite(first) and first > 0 and not _is_ramped(scene, first):
        yield Motion("the first mode", first)
    driven = scene.stated_input
    if scene.column is not None and driven is not None and driven.frequency is not None:
        yield Motion("the input", 2 * math.pi * driven.frequency)


def _moves_as_a_whole(scene: Scene) -> bool:
    """Whether a block may slide or turn, which springs that ring below it do not change."""
    load = scene.load
    slides = scene.contact.friction is not None and (load.slope != 0 or load.base_motion is not None)
    return slides or scene.run.geometry == "updated"


def _is_driven_slowly(scene: Scene) -> bool:
    """Whether nothing but a record moves the block: its samples hold no more than the step shows."""
    load = scene.load
    return load.base_motion is not None and load.gravity == 0 and load.pressure == 0 and not load.off_centre


def _is_ramped(scene: Scene, frequency: float) -> bool:
    """Whether the loads rise so slowly that they hardly move a mode."""
    return scene.kind.name == "block" and scene.block.velocity == 0 and frequency * scene.load.ramp >= LONG_RAMP


def first_frequency(scene: Scene) -> float | None:
    """Return the frequency of the first mode [rad/s], contacts closed and sticking; None where there is none."""
    if scene.column is not None:
        return columns.first_frequency(scene.column)
    if math.prod(scene.block.subdivide or (1,)) > MOST_SUB_BLOCKS:
        return None
    with suppress(InputError):  # DDA does not take the scene
        return dda_modes(closed(scene))[0].frequency
    return None


def closed(scene: Scene) -> Scene:
    """Return a scene whose contact stays closed: its springs locked, of a rigid stop as stiff as rounding allows."""
    if features.linear(scene):
        return scene
    stiffness = min(scene.contact.stiffness, 1e6 * scene.block.young)
    contact = type(scene.contact)(stiffness=stiffness)
    run = scene.run.model_copy(update={"geometry": "small", "rotation": "exact"})
    damping = scene.damping.model_copy(update={"kinetic": "constant"})
    return scene.model_copy(update={"stated_contact": contact, "run": run, "damping": damping})
