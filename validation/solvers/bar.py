"""Adapters of the exact bar: under the Newmark scheme, and in continuous time."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping

import numpy as np

import fem_reference
from validation.runs.contact import ContactRecord
from validation.runs.history import Array, Complex, History
from validation.runs.modes import Mode, Switch
from validation.runs.run import Outcome, Run
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.columns.layers import time_of
from validation.solvers.contract import OF_SCHEMES, LineStyle, NotReported, Prepared, Role, Solver
from validation.solvers.events import BAR_COLUMNS as OPENING_COLUMNS
from validation.solvers.fem import MESH_SECTIONS, OF_SUB_BLOCKS, problem_of, scheme_of
from validation.solvers.translation import check_columns, naming, switches_between_steps, to_modes, to_run

BAR_COLUMNS = ("displacement", "contact_pressure")


def bar_of(scene: Scene) -> fem_reference.Bar:
    """Return the bar of a scene."""
    from fem_reference.exact.bar import Bar

    with naming(scene):
        return Bar.of(problem_of(scene))


class NewmarkBar(Prepared):
    """A bar under the scheme of its scene; there is nothing to save."""

    def __init__(self, scene: Scene, name: str) -> None:
        self.scene = scene
        self.name = name
        self.bar = bar_of(scene)
        self.scheme = self.scheme_of_bar()

    def scheme_of_bar(self) -> fem_reference.Scheme:
        """Return the scheme of the scene."""
        return scheme_of(self.scene)

    def history_run(self) -> Run:
        """Run the scene."""
        check_columns(self.scene, BAR_COLUMNS)
        return to_run(self.scene, self.history())

    def history(self) -> fem_reference.Result:
        """Return the history under the Newmark scheme."""
        return self.bar.solve(self.scheme, self.scene.time.steps, self.scene.run.columns)

    def static(self) -> Mapping[str, float]:
        """Return the static solution."""
        return self.bar.static()

    def modes(self) -> tuple[Mode, ...]:
        """Return the lowest modes."""
        return to_modes(self.bar.modes(self.scheme))

    def diagnostics(self) -> Mapping[str, float]:
        """Raise: the bar has no matrix and modes without end."""
        raise NotReported("bar: the exact bar has no matrix and no largest frequency")

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Return the frequency response, exact in space."""
        from fem_reference.exact.vibration import response

        return response(self.bar, self.scheme, frequencies, BAR_COLUMNS, exact)


class OpeningBar(Prepared):
    """A bar on a spring that carries no tension, under the scheme of its scene; there is nothing to save."""

    def __init__(self, scene: Scene, name: str) -> None:
        from fem_reference.exact.opening_bar import OpeningBar as Exact

        self.scene = scene
        self.name = name
        self.scheme = scheme_of(scene)
        with naming(scene):
            self.bar = Exact.of(problem_of(scene), scene.contact.gap, scene.block.velocity)

    def history_run(self) -> Run:
        """Run the scene."""
        check_columns(self.scene, OPENING_COLUMNS)
        with np.errstate(over="ignore", invalid="ignore"):
            result = self.bar.solve(self.scheme, self.scene.time.steps)
        self.result = result
        displacement, pressure, gap, *_ = result.columns.values()
        force = pressure * self.bar.width / 2
        values = (displacement, pressure, gap, gap, force, force)
        columns = dict(zip(OPENING_COLUMNS, values, strict=True))
        history = History(result.time, {name: columns[name] for name in self.scene.run.columns})
        seconds = {"setup": result.setup_seconds, "stepping": result.stepping_seconds}
        notes = ("exact in space: a bar on a spring that carries no tension",)
        return Run(Outcome.COMPLETED, history, {"steps": len(result.time)}, seconds, notes)

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches of the base between the steps."""
        return switches_between_steps({"base": self.result.columns["closed"] == 0}, self.result.time)

    def contact_record(self) -> ContactRecord:
        """Return what the contact did; the bar reports no energies."""
        _, pressure, gap, closed, velocity = self.result.columns.values()
        force = pressure * self.bar.width
        return opened.record(
            self.scene,
            time=self.result.time,
            force=force,
            impulse=opened.impulse_of_contact(self.scene, force, velocity),
            penetration=np.maximum(0.0, -gap),
            gap=np.maximum(0.0, gap),
            open_share=1 - closed,
            velocity=velocity,
            rebounds=opened.rebounds(np.array([gap]), self.scheme.step),
        )


class ExactBar(Solver):
    """Exact in space, in time a scheme's."""

    name = "bar"
    handles: frozenset[str] = (
        features.SCHEMES
        | features.COURSES
        | frozenset({features.SUB_BLOCKS, features.UNILATERAL, features.WEIGHT, features.DAMPING})
    )
    apart = ((features.UNILATERAL, features.COURSES), *features.DAMPING_APART)
    sections: tuple[str, ...] = (*MESH_SECTIONS, "damping")
    unread: tuple[str, ...] = OF_SUB_BLOCKS
    sources: tuple[str, ...] = ("fem_reference",)
    role = Role.REFERENCE
    rank = 5.0
    line: LineStyle | None = LineStyle("#000000", (), 0.8, 3)

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has; beyond the first two of contact that opens."""
        return OPENING_COLUMNS if features.UNILATERAL in self.handles else BAR_COLUMNS

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the bar is not exact for this scene."""
        from fem_reference.exact import bar, opening_bar
        from fem_reference.scheme import modal

        scheme = scheme_of(scene)
        if features.UNILATERAL in features.of(scene):
            reason = opening_bar.applicable(problem_of(scene)) or opening_bar.steppable(scheme)
        else:
            reason = bar.applicable(problem_of(scene))
        return reason or modal.applicable(scheme)

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Build the bar, on a locked spring or on one that carries no tension."""
        opens = features.UNILATERAL in features.of(scene)
        return OpeningBar(scene, self.name) if opens else NewmarkBar(scene, self.name)


class ContinuousBar(NewmarkBar):
    """A bar in continuous time; gg is the rate -ln(gg) / dt."""

    def scheme_of_bar(self) -> fem_reference.Scheme:
        """Return the step and the discount of the scene."""
        return time_of(self.scene)

    def history(self) -> fem_reference.Result:
        """Return the history, exact in time."""
        return self.bar.continuum(self.scheme, self.scene.time.steps, self.scene.run.columns)

    def modes(self) -> tuple[Mode, ...]:
        """Return the lowest modes with the eigenvalues exp((-c/2 +- sqrt(c^2/4 - w^2)) dt).

        The rate of a mode is c = -ln(gg) / dt + a0 + a1 w^2.
        """
        step = self.scene.time.step
        damping = self.scene.damping
        rate = damping.mass - math.log(self.scene.time.discount) / step
        exact_modes = []
        for mode in super().modes():
            half_rate = (rate + damping.stiffness * mode.frequency**2) / 2
            factors = _factors(mode.frequency, half_rate, step)
            exact_modes.append(Mode(mode.frequency, mode.share, factors, None, True))
        return tuple(exact_modes)

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Return the frequency response, exact in space and time."""
        return super().amplitudes(frequencies, exact=True)


def _factors(w: float, half_rate: float, step: float) -> tuple[complex, complex]:
    """Return the factors by which a damped oscillation changes in a step."""
    root = cmath.sqrt(half_rate**2 - w**2)
    return cmath.exp((root - half_rate) * step), cmath.exp((-root - half_rate) * step)


class Continuum(ExactBar):
    """Exact in space and time."""

    name = "continuum"
    unread = (*OF_SUB_BLOCKS, *OF_SCHEMES)
    handles = features.SCHEMES | {features.SUB_BLOCKS, features.DAMPING}
    role = Role.TRUTH
    rank = 6.0
    line = LineStyle("#999999", (), 0.7, 1)

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why there is no closed form for this scene."""
        from fem_reference.exact import bar

        stopped = "gg = 0 has no rate -ln(gg) / dt" if scene.time.discount == 0 else None
        return bar.applicable(problem_of(scene)) or stopped

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Build the bar."""
        return ContinuousBar(scene, self.name)
