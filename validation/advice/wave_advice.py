r"""Blocks and time step for a wave: how much of it a column of blocks under the scheme lets arrive, and when.

In blocks of height h the scheme carries a wave e^{iwt - ikx} with cos(kh) = (6 - 2 L)/(6 + L), L = W2 h^2 rho / M
(`validation.theory.waves`). Over a distance X it keeps exp(-|Im k| X) and arrives (Re k - w/c) X / (2 pi) periods late.
The blocks are made small enough for half of the phase error in exact time; then the step is the largest with which the
loss and the whole phase error are kept. Under a conditionally stable scheme the step also stays below the limit of the
solver's own model of these blocks, whose glue, joints and contact springs may be far faster than the blocks.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace

import numpy as np

from validation.advice.hooks import AdviceHooks, Layer
from validation.advice.limits import Limit
from validation.advice.plain import PlainAnswer
from validation.advice.response import check_scene
from validation.advice.spectra import highest_frequency
from validation.advice.words import say
from validation.models.column.tables import NEAR
from validation.runs.history import ArrayPair, Complex
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.theory.edges import edge
from validation.theory.stepping import Stepping

MOST_BLOCKS = 10_000_000
ROUNDING = 1e-12  # of a loss, a delay or a damping ratio that is none
LIMITS = (
    Limit("--fmax", "must be finite and positive"),
    Limit("--wavelengths", "must be finite and positive"),
    Limit("--loss", "must be above 0 and below 1", below=1.0),
    Limit("--phase-error", "must be above 0 and below 1", below=1.0),
)
GRID = 400  # steps looked at, from 1e-6 periods to half a period


@dataclass(frozen=True)
class Passage:
    """What becomes of a wave over its distance, with some blocks and a step."""

    step: float  # dt [s]
    gg: float  # discount of a step
    heights: tuple[float, ...]  # of a block of each layer [m]
    loss: float  # share of the amplitude that is lost [1]
    delay: float  # of the arrival [periods]
    damping: float  # steady ratio -Im W / |W| of the step at the frequency [1]


@dataclass(frozen=True)
class WaveAdvice(PlainAnswer):
    """Blocks and step for a wave, what limits them, and what the present ones do."""

    scene: str
    frequency: float  # F [Hz]
    loss: float  # L, share of the amplitude that may be lost [1]
    phase_error: float  # of the arrival that is allowed [periods]
    distance: float  # [m]
    wavelengths: float  # in that distance [1]
    present: Passage
    advised: Passage | None  # None where nothing is good enough
    blocks: tuple[int, ...]  # advised number for each layer, empty where none is enough
    limits_height: str
    limits_step: str
    sentence: str = ""  # what the present ones do
    advice: str = ""  # what is advised, or why nothing is


@dataclass(frozen=True)
class _WavePath:
    """Layers and how far the wave runs, over their thickness."""

    layers: tuple[Layer, ...]
    frequency: float
    times: float

    @property
    def omega(self) -> float:
        return 2 * math.pi * self.frequency

    @property
    def wavelengths(self) -> float:
        return self.times * sum(layer.thickness / layer.speed for layer in self.layers) * self.frequency

    def passed(self, w2: Complex) -> ArrayPair:
        """Return loss and delay in periods at squared frequencies."""
        decay = np.zeros(np.shape(w2))
        phase = np.zeros(np.shape(w2))
        for layer in self.layers:
            k = layer.wavenumber(w2)
            decay += np.abs(k.imag) * layer.thickness
            phase += (k.real - self.omega / layer.speed) * layer.thickness
        return -np.expm1(-self.times * decay), self.times * phase / (2 * math.pi)

    def passage(self, stepping: Stepping) -> Passage:
        w2 = stepping.squared_frequency([self.omega])
        loss, delay = self.passed(w2)
        # the damping ratio of a vibration that a load keeps up
        W = np.sqrt(w2[0])
        values = (loss[0], delay[0], float(-W.imag / np.abs(W)))
        rounded = (0.0 if abs(value) < ROUNDING else float(value) for value in values)
        return Passage(stepping.step, stepping.gg, tuple(layer.height for layer in self.layers), *rounded)


@dataclass(frozen=True)
class _LargestStep:
    """The largest step with which a wave arrives, and what limits it; without one, the least loss at a stable step."""

    step: float | None  # dt [s]; None where no step is good enough
    limit: str
    least_loss: float = 1.0  # share of the amplitude [1]
    least_loss_at: float | None = None  # dt [s]; None where no step of the grid is stable


def advise_wave(
    scene: Scene, frequency: float, loss: float, wavelengths: float | None = None, phase_error: float = 0.05
) -> WaveAdvice:
    """Return the height of blocks and the time step that let a wave arrive.

    Parameters
    ----------
    scene
        A scene without a sweep, with a column or with a block that is an upright rectangle, whose rows of sub-blocks
        are the blocks. Its scheme and discount stay (a discount stated as `gg_rate` as a rate), and so does its glue;
        joints and reflections between layers are left out.
    frequency
        Of the wave [Hz].
    loss
        Share of its amplitude that may be lost [1].
    wavelengths
        Distance that it runs, in wavelengths; the height of the column by default.
    phase_error
        By how many periods the wave may arrive early or late.

    Raises
    ------
    InputError
        A number is out of range, or the scene is not linear or no such column, or its step samples the wave less than
        twice a period.
    """
    for limit, value in zip(LIMITS, (frequency, wavelengths, loss, phase_error), strict=True):
        limit.check(value)
    check_scene(scene)
    # beyond half the sampling rate the steps see an alias
    step = scene.time.step
    beyond = say("alias of a wave", limit=0.5 / step, step=step)
    cure = "take a lower frequency or a smaller step"
    Limit("--fmax", beyond, below=0.5 / step * (1 + 2e-12), advice=cure).check(frequency)
    features.refuse_damping(scene, "advise")
    layers = AdviceHooks.of(scene).layers(scene)
    path = _WavePath(layers, frequency, 1.0)
    if wavelengths is not None:
        path = replace(path, times=wavelengths / path.wavelengths)
    present = path.passage(Stepping.of(scene))
    largest = _LargestStep(None, "blocks")
    advised = None
    blocks: tuple[int, ...] = ()
    cut, limits_height = _cut(path, phase_error / 2)
    if cut is not None:
        largest = _largest_step(scene, cut, loss, phase_error)
        if largest.step is not None:
            advised = cut.passage(Stepping.of(scene).at(largest.step))
            blocks = tuple(layer.blocks for layer in cut.layers)
    advice = WaveAdvice(
        scene=scene.name,
        frequency=frequency,
        loss=loss,
        phase_error=phase_error,
        distance=path.times * sum(layer.thickness for layer in layers),
        wavelengths=path.wavelengths,
        present=present,
        advised=advised,
        blocks=blocks,
        limits_height=limits_height,
        limits_step=largest.limit,
    )
    return replace(advice, sentence=_sentence(scene, advice), advice=_advised(scene, advice, largest))


def _cut(path: _WavePath, allowed: float) -> tuple[_WavePath | None, str]:
    """Return the path with the fewest blocks that delay a wave in exact time no more than allowed, and what limits."""
    layers = []
    for layer in path.layers:
        alone = replace(path, layers=(layer,))
        blocks = _fewest(alone, allowed * alone.wavelengths / path.wavelengths)
        if blocks is None:
            return None, "glue"
        layers.append(replace(layer, blocks=_with_joints_between(layer, blocks)))
    single_block = all(layer.blocks == 1 for layer in layers)
    return replace(path, layers=tuple(layers)), "column" if single_block else "phase error"


def _with_joints_between(layer: Layer, blocks: int) -> int:
    """Return the least number of blocks from `blocks` on with which every joint lies where two blocks meet.

    The present number does so, and with it every multiple of it.
    """
    if not layer.joints:
        return blocks
    last = math.ceil(blocks / layer.blocks) * layer.blocks
    fitting = (
        n for n in range(blocks, last) if all(abs(n * share - round(n * share)) <= NEAR * n for share in layer.joints)
    )
    return next(fitting, last)


def _fewest(path: _WavePath, allowed: float) -> int | None:
    """Return the fewest blocks of a layer that are good enough, or None where the glue lets none be."""
    w2 = np.array([path.omega**2 + 0j])

    def good(blocks: int) -> bool:
        loss, delay = replace(path, layers=(replace(path.layers[0], blocks=blocks),)).passed(w2)
        return bool(abs(delay[0]) <= allowed and loss[0] < 1e-9)

    blocks = 1
    while not good(blocks):
        if blocks >= MOST_BLOCKS:
            return None
        blocks = math.ceil(1.05 * blocks)
    while blocks > 1 and good(blocks - 1):
        blocks -= 1
    return blocks


def _largest_step(scene: Scene, path: _WavePath, loss: float, allowed: float) -> _LargestStep:
    """Return the largest step with which the wave arrives, and what limits it.

    Stable is what DDA's solver takes on the advised blocks, with glue, joints and springs. A discount that keeps its
    rate changes with the step, and with it the critical w dt of the scheme.
    """
    scheme = Stepping.of(scene)
    blocks = [layer.blocks for layer in path.layers]
    highest = functools.cache(lambda: highest_frequency(AdviceHooks.of(scene).cut(scene, blocks)))

    def is_stable(step: float) -> bool:
        critical = scheme.at(step).critical_omega
        return math.isinf(critical) or step * highest() <= critical

    def passed(step: float) -> tuple[float, float]:
        lost, delay = path.passed(scheme.at(step).squared_frequency([path.omega]))
        return float(lost[0]), float(abs(delay[0]))

    def arrives(step: float) -> bool:
        lost, delay = passed(step)
        return lost <= loss and delay <= allowed

    def good(step: float) -> bool:
        return is_stable(step) and arrives(step)

    steps = np.geomspace(0.5 / path.frequency, 1e-6 / path.frequency, GRID).tolist()
    first = next((i for i, step in enumerate(steps) if good(step)), None)
    if first is None:
        losses = [passed(step)[0] for step in steps]
        limit = "gg" if min(losses) > loss and scene.time.discount < 1 else "scheme"
        if any(map(arrives, steps)):  # but not stably
            limit = "stability"
        stable = ((lost, step) for lost, step in zip(losses, steps, strict=True) if is_stable(step))
        return _LargestStep(None, limit, *min(stable, default=()))
    if first == 0:
        return _LargestStep(steps[0], "half a period")
    step = edge(good, steps[first], steps[first - 1], ROUNDING)
    beyond = step * (1 + 1e-6)
    if not is_stable(beyond):
        return _LargestStep(step, "stability")
    limit = "loss" if passed(beyond)[0] > loss else "phase error"
    return _LargestStep(step, limit)


def _sentence(scene: Scene, advice: WaveAdvice) -> str:
    kinetic, algorithmic = Stepping.of(scene).rayleigh()
    kind = "algorithmic and kinetic"
    if kinetic == 0:
        kind = "algorithmic"
    elif algorithmic == 0:
        kind = "kinetic"
    damps = say("steady", advice.present, kind=kind) if advice.present.damping else "damps nothing"
    return say("present wave", advice, damps=damps, arrives=1 - advice.present.loss, late=_late(advice.present))


def _advised(scene: Scene, advice: WaveAdvice, largest: _LargestStep) -> str:
    if advice.advised is not None:
        heights = ", ".join(f"{h:.4g}" for h in advice.advised.heights)
        return say("advised wave", advice, heights=heights, late=_late(advice.advised))
    if advice.limits_height == "glue":
        return say("glue too soft")
    if largest.least_loss_at is None:
        return say("no stable step")
    gg = "rate takes the rest" if scene.time.gg_rate is not None else "gg takes the rest"
    cures = {"gg": gg, "stability": "larger steps unstable", "scheme": "another scheme"}
    return say("no step", largest, cure=say(cures[largest.limit]))


def _late(passage: Passage) -> str:
    return f"{abs(passage.delay):.3g} periods {'late' if passage.delay >= 0 else 'early'}"
