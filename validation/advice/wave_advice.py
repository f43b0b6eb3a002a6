r"""Blocks and time step for a wave: how much of it a column of blocks under the scheme lets arrive, and when.

In blocks of height h the scheme carries a wave e^{iwt - ikx} with cos(kh) = (6 - 2 L)/(6 + L), L = W2 h^2 rho / M
(`validation.theory.waves`). Over a distance X it keeps exp(-|Im k| X) and arrives (Re k - w/c) X / (2 pi) periods late.
The blocks are made small enough for half of the phase error in exact time; then the step is the largest with which the
loss and the whole phase error are kept. Under a conditionally stable scheme the step also stays below the limit of the
solver's own model of these blocks, whose glue, joints and contact springs may be far faster than the blocks.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from validation.advice.hooks import AdviceHooks, Layer
from validation.advice.limits import Limit
from validation.advice.plain import PlainAnswer
from validation.advice.response import check_scene
from validation.advice.spectra import highest_frequency
from validation.errors import InputError
from validation.models.column.tables import NEAR
from validation.runs.history import ArrayPair, Complex
from validation.runs.numbers import share_text
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
    sentence: str  # what the present ones do
    advice: str  # what is advised, or why nothing is


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
        loss, delay = self.passed(stepping.squared_frequency([self.omega]))
        # The damping ratio xi = -Im W / |W| of a vibration that a load keeps up, at a frequency in Hz.
        W = np.sqrt(stepping.squared_frequency(2 * np.pi * np.asarray(self.frequency, float)))
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
    _check_sampled(frequency, scene.time.step)
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
    return WaveAdvice(
        scene.name,
        frequency,
        loss,
        phase_error,
        path.times * sum(layer.thickness for layer in layers),
        path.wavelengths,
        present,
        advised,
        blocks,
        limits_height,
        largest.limit,
        _sentence(scene, path, present),
        _advised(scene, advised, limits_height, largest),
    )


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
    """Return the largest step with which the wave arrives, and what limits it."""
    is_stable = _stability(scene, path)

    def passed(step: float) -> tuple[float, float]:
        lost, delay = path.passed(Stepping.of(scene).at(step).squared_frequency([path.omega]))
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


def _stability(scene: Scene, path: _WavePath) -> Callable[[float], bool]:
    """Return whether a step is stable on the advised blocks, as DDA's solver has them with glue, joints and springs.

    A discount that keeps its rate changes with the step, and with it the critical w dt of the scheme.
    """
    scheme = Stepping.of(scene)
    # without a limit at any discount: Newmark's with 2 alpha >= delta >= 1/2, and every other implicit scheme
    is_newmark = scheme.scheme == "newmark"
    if 2 * scheme.alpha >= scheme.delta >= 0.5 if is_newmark else scheme.scheme != "leapfrog":
        return lambda step: True
    highest = highest_frequency(AdviceHooks.of(scene).cut(scene, [layer.blocks for layer in path.layers]))

    def is_stable(step: float) -> bool:
        return step * highest <= scheme.at(step).critical_omega

    return is_stable


def _check_sampled(frequency: float, step: float) -> None:
    """Refuse a frequency that a time step samples less than twice a period: the steps see its alias, a lower one."""
    limit = 0.5 / step
    if frequency > limit * (1 + 1e-12):
        raise InputError(
            f"must be at most {limit:.6g} Hz, 1 / (2 dt) of the time step {step:g} s, "
            "beyond which the steps see an alias",
            field="--fmax",
            value=f"{frequency:g}",
            advice="take a lower frequency or a smaller step",
        )


def _sentence(scene: Scene, path: _WavePath, present: Passage) -> str:
    """Say what the present blocks and step do to the wave."""
    kinetic, algorithmic = Stepping.of(scene).rayleigh()
    kind = "algorithmic and kinetic"
    if kinetic == 0:
        kind = "algorithmic"
    elif algorithmic == 0:
        kind = "kinetic"
    distance = path.times * sum(layer.thickness for layer in path.layers)
    late = "late" if present.delay >= 0 else "early"
    damping = f"has a steady ratio of {share_text(present.damping)}, {kind}," if present.damping else "damps nothing"
    return (
        f"Your dt = {present.step:g} s {damping} at {path.frequency:g} Hz: "
        f"{share_text(1 - present.loss)} of a wave arrives after {distance:.4g} m, {path.wavelengths:.3g} wavelengths, "
        f"{abs(present.delay):.3g} periods {late}."
    )


def _advised(scene: Scene, advised: Passage | None, height: str, largest: _LargestStep) -> str:
    """Say what is advised and what limits it, or why nothing is."""
    if advised is not None:
        heights = ", ".join(f"{h:.4g}" for h in advised.heights)
        late = "late" if advised.delay >= 0 else "early"
        return (
            f"Blocks of {heights} m and dt = {advised.step:.4g} s lose {share_text(advised.loss)} of it and bring it "
            f"{abs(advised.delay):.3g} periods {late}; "
            f"the blocks are limited by the {height}, the step by the {largest.limit}."
        )
    if height == "glue":
        return "No block height does: the glue between them is too soft for the phase error; raise block.glue_ratio."
    unconditional = "choose 2 alpha >= delta >= 1/2, which is stable at every step"
    if largest.least_loss_at is None:
        return f"No time step does: none above a millionth of a period is stable; {unconditional}."
    gg = "gg_rate" if scene.time.gg_rate is not None else "gg"
    cures = {
        "gg": f"{gg} takes the rest, choose it nearer {0 if gg == 'gg_rate' else 1}",
        "stability": f"larger steps are unstable, {unconditional}",
        "scheme": "choose another scheme",
    }
    best = f"{share_text(largest.least_loss)} is lost, at dt = {largest.least_loss_at:.3g} s"
    return f"No time step does: at best {best}; {cures[largest.limit]}."
