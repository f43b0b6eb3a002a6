"""The damping that a scene really has: total, algorithmic and kinetic, mode by mode.

The scheme's closed forms (trace and determinant of one step, `dda.scheme.spectral`; of schemes other than Newmark's the
roots of `validation.theory.stepping`) are evaluated at the frequencies of the DDA block. The total damping ratio xi is
that of the scheme with its discount gg, the algorithmic part that of it at gg = 1, the kinetic part the rest.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dda.scheme import roots as scheme_roots
from dda.scheme import spectral
from dda.scheme.newmark import Scheme
from dda.scheme.spectral import ComplexArray
from validation.advice.plain import PlainAnswer
from validation.advice.words import say
from validation.metrics.modes import operator_damping
from validation.runs.modes import Mode, contact_index
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers import memory
from validation.solvers.contract import NotReported, Role, Solver
from validation.solvers.registry import by_role, get_solver
from validation.theory.stepping import Stepping

FLIPPING = -0.9  # a root whose real part is below turns the mode over every step, with next to no damping
FIRST = "first axial"
CONTACT = "contact"


@dataclass(frozen=True)
class ModeDamping:
    """Damping of one mode of the DDA block by the scheme of a scene."""

    name: str
    frequency: float  # w, undamped natural [rad/s]
    damping: float | None  # total damping ratio xi [1]; None where a root is not positive
    spectral_radius: float  # max |lambda| [1]
    omega_dt: float  # Omega = w dt [1]
    algorithmic: float | None  # xi of the same scheme at gg = 1 [1]
    kinetic: float | None  # what the discount adds [1]
    period_elongation: float | None  # w / w' - 1 [1]
    least_root: float  # real part of the eigenvalue nearest to -1 [1]
    viscous: float | None = 0.0  # what damping tables add to xi [1]

    @property
    def flips(self) -> bool:
        """Whether the mode changes sign every step and is hardly damped."""
        return self.least_root <= FLIPPING


@dataclass(frozen=True)
class Damping(PlainAnswer):
    """Damping of a scene: modes of the DDA block, first axial mode first, and the reference's first mode."""

    scene: str
    step: float  # dt [s]
    gg: float  # discount per step [1]
    gg_rate: float | None  # c = -ln(gg) / dt [1/s]; None at gg = 0
    modes: tuple[ModeDamping, ...]
    references: dict[str, dict[str, float | None]]  # solver -> frequency and damping of its first axial mode
    sentence: str
    alias: float | None = None  # what samples show of the continuum's first mode where it lies beyond pi / dt [rad/s]


def number(value: float) -> float | None:
    """Return a finite number, or None."""
    return float(value) if math.isfinite(value) else None


def mode_names(modes: Sequence[Mode]) -> list[str]:
    """Name modes: the first axial one, the contact mode (see `runs.modes.contact_index`), the others by number."""
    names = [f"mode {i + 1}" for i in range(len(modes))]
    contact = contact_index(modes)
    if contact is not None:
        names[contact] = CONTACT
    names[0] = FIRST
    return names


def mode_damping(scene: Scene, name: str, frequency: float) -> ModeDamping:
    """Return the damping of a mode of the given frequency [rad/s] under the scheme of a scene."""
    t = scene.time
    omega = frequency * t.step
    if t.scheme != "newmark":
        stepping = Stepping.of(scene)
        numerical = stepping.damping_ratio(omega)
        algorithmic = replace(stepping, gg=1.0).damping_ratio(omega)
        roots = stepping.roots(omega)[:2]
        radius = stepping.spectral_radius(omega)
        elongation = stepping.period_error(omega)
    else:
        numbers = (omega, t.alpha, t.delta, t.discount)
        numerical = float(spectral.damping_ratio(*numbers))
        algorithmic = float(spectral.damping_ratio(omega, t.alpha, t.delta))
        roots = spectral.eigenvalues(*numbers)
        radius = float(spectral.spectral_radius(*numbers))
        elongation = float(spectral.period_elongation(*numbers))
    total = numerical
    tables = scene.damping
    if tables.present:
        viscous = Scheme(
            t.alpha, t.delta, t.discount, t.step, mass_damping=tables.mass, stiffness_damping=tables.stiffness
        )
        total = scheme_roots.damping_ratio(viscous, omega)
        roots = np.array(scheme_roots.eigenvalues(viscous, omega))
        radius = float(np.max(np.abs(roots)))
        elongation = _elongation(omega, roots)
    return ModeDamping(
        name,
        frequency,
        number(total),
        radius,
        omega,
        number(algorithmic),
        number(numerical - algorithmic),
        number(elongation),
        float(np.min(roots.real)),
        number(total - numerical) if t.scheme == "newmark" else 0.0,
    )


def steps_to(level: float, radius: float) -> float:
    """Return the step at which an amplitude that keeps a share `radius` per step falls to a level."""
    if level >= 1 or radius <= 0:
        return 1.0
    return math.log(level) / math.log(radius) if radius < 1 else math.inf


def _elongation(omega: float, roots: ComplexArray) -> float:
    """Return w/w' - 1 of two eigenvalues, NaN where a root is not positive."""
    if np.any((roots.imag == 0) & (roots.real <= 0)):
        return math.nan
    return omega / math.sqrt(abs(np.prod(np.log(roots)))) - 1


def dda_modes(scene: Scene) -> tuple[Mode, ...]:
    """Return the modes of the DDA block that the load reaches, the first axial one first.

    Raises
    ------
    InputError
        One value must be picked for a swept field, or there are no modes.
    """
    features.refuse_column(scene, "damping")
    features.refuse_sweep(scene)
    features.refuse_nonlinear(scene, "modes and damping ratios exist")
    return checked("dda", scene).modes(scene)


def checked(solver: str, scene: Scene) -> Solver:
    """Return a solver whose model of the scene fits into memory, or raise InputError; its modes take no step."""
    chosen = get_solver(solver)
    memory.check(scene.with_values({"time.steps": 1}), chosen)
    return chosen


def stable_step(scene: Scene) -> float:
    """Return the largest stable step of the scene as DDA's solver judges it [s]; infinite where every step is stable.

    It is the critical w dt of the scheme over the highest natural frequency of the solver's own model, with its contact
    springs, glue and joints: a spring between two blocks can be far faster than the blocks.

    Raises
    ------
    InputError
        DDA refuses the scene, or its model does not fit into memory.
    """
    critical = Stepping.of(scene).critical_omega
    return critical if math.isinf(critical) else critical / highest_frequency(scene)


def highest_frequency(scene: Scene) -> float:
    """Return the highest natural frequency of DDA's model of the scene [rad/s], refused as in `stable_step`."""
    frequency = checked("dda", scene).prepare(scene).highest_frequency()
    if frequency is None:
        raise NotReported("dda reports no limit of the step")
    return frequency


def damping(scene: Scene, references: bool = False) -> Damping:
    """Return the damping that a scene really has, mode by mode.

    Parameters
    ----------
    scene
        A scene without a sweep.
    references
        Also return the first axial mode of the finite elements and, where it applies, of the exact bar.

    Raises
    ------
    InputError
        The scene has a sweep, or a model of it does not fit into memory.

    Examples
    --------
    >>> from validation import damping, load_scene
    >>> scene_damping = damping(load_scene("figures-3-4").with_values({"time.step": 0.002}))
    >>> round(scene_damping.modes[0].damping, 4)
    0.1602
    """
    dda = dda_modes(scene)
    modes = [mode_damping(scene, name, mode.frequency) for name, mode in zip(mode_names(dda), dda, strict=True)]
    t = scene.time
    reference_modes = {}
    sampled = None
    if references:
        first_modes = {name: first_mode(scene, name) for name in ("fem", "bar")}
        reference_modes = {name: values for name, values in first_modes.items() if values}
        sampled = alias(scene)
    rate = rate_of(t.discount, t.step)
    text = say("modes", step=t.step, first=modes[0], runs=runs(modes[0]))
    text += "".join(say("modes, contact", runs=runs(mode)) for mode in modes if mode.name == CONTACT)
    return Damping(scene.name, t.step, t.discount, rate, tuple(modes), reference_modes, f"{text}.", sampled)


def rate_of(gg: float, step: float) -> float | None:
    """Return the rate c of gg = exp(-c dt) [1/s]; None where the discount takes all."""
    return -math.log(gg) / step + 0.0 if gg > 0 else None


def truth_of(scene: Scene) -> str | None:
    """Return the exact solution that takes a scene, None where none does."""
    return next((name for name in by_role(Role.TRUTH) if not get_solver(name).refusal(scene)), None)


def alias(scene: Scene) -> float | None:
    """Return what samples show of the continuum's first mode [rad/s]; None below pi / dt or without a solution."""
    name = truth_of(scene)
    with contextlib.suppress(NotReported):
        return checked(name, scene).modes(scene)[0].alias(scene.time.step) if name else None
    return None


def first_mode(scene: Scene, solver: str) -> dict[str, float | None]:
    """Return frequency and damping of a reference's first axial mode; empty where it does not apply."""
    if get_solver(solver).refusal(scene):
        return {}
    mode = checked(solver, scene).modes(scene)[0]
    xi = operator_damping(mode.eigenvalues)
    return {"frequency": mode.frequency, "damping": xi if isinstance(xi, float) else None}


# ---- sentences ----


def runs(mode: ModeDamping) -> str:
    """Say in words how a mode is damped."""
    if mode.spectral_radius > 1 + 1e-12:
        kind = "grows"
    elif mode.flips:
        kind = "flips"
    elif mode.damping is None:
        kind = "no ratio"
    elif mode.damping < 5e-16:
        kind = "undamped"
    else:
        return say("overdamped" if mode.damping >= 1 else "damped", parts=parts(mode), damping=mode.damping)
    return say(kind, mode)


def parts(mode: ModeDamping) -> str:
    """Say which part of the damping is algorithmic, which is kinetic, and which is of damping tables."""
    shares = {name: getattr(mode, name) for name in ("algorithmic", "kinetic", "viscous")}
    if mode.damping is None or None in shares.values():
        return "kinetic and algorithmic"
    least = 1e-9 * mode.damping
    there = [name for name, share in shares.items() if abs(share) > least]
    if len(there) == 1 and not mode.viscous:
        return f"all of it {there[0]}"
    texts = [say("share", share=shares[name], name=name) for name in there]
    return " and ".join(filter(None, [", ".join(texts[:-1]), texts[-1]]))
