"""The study `response`: what the paper's block answers to a load and to a base that vibrates.

Under its pressure the responses of `dda`, `bar` and `fem` are held to closed forms at the squared frequency that the
steps make of w, and `fem` to the bar at the error of its mesh. On a base that vibrates they are held to stepped
histories, after the transients.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from validation.advice.response import Response, polar, response
from validation.engine.finished import Derived, DerivedRows, Finished
from validation.gates.gate import Gate
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.runs.row import Metrics, Value
from validation.scenes.record import read_record
from validation.scenes.scene import Scene, load_scene
from validation.suite.bands import Band, about, cases, gate, short
from validation.theory import vibration
from validation.theory.spectra import EPS, bar_frequency, dda_frequency, roots
from validation.theory.statics import moduli, size
from validation.theory.stepping import Complex, Stepping

BASE = "response-base"
DAMPING = "response-damping"
FREQUENCIES = (20.0, 52.0, 80.0, 150.0)  # Hz
RESONANCE = 52.0  # Hz, next to the first frequency
LOW = (5.0, 10.0, 20.0)  # Hz
WINDOWS = {BASE: 250, DAMPING: 200}  # last steps, whole periods of all frequencies of a record
MESH = 8  # elements along the height, linear: their closed form is that of a column of welded blocks
SOLVERS = ("dda", "fem")
SOLVED = 1e-13  # of a response: where its solver stops
COLUMNS = {DISPLACEMENT: "displacement", PRESSURE: "pressure"}
DRAWN = np.linspace(1.0, 200.0, 399)  # Hz


@dataclass(frozen=True)
class Answer:
    """A way in which the block answers its pressure: a scheme, or exact time."""

    name: str
    words: str
    scene: Scene
    exact: bool = False

    def squared_frequencies(self, frequencies: tuple[float, ...]) -> Complex:
        """Return W2 [1/s^2]."""
        w = 2 * np.pi * np.array(frequencies)
        return np.asarray(w * w, complex) if self.exact else Stepping.of(self.scene).squared_frequency(w)

    def closed(self, solver: str, frequency: float) -> vibration.Vibration:
        """Return the closed form of a solver's model."""
        w2 = self.squared_frequencies((frequency,))
        if solver == "fem":
            return vibration.elements(self.scene, w2, MESH)
        return {"dda": vibration.block, "bar": vibration.bar}[solver](self.scene, w2)

    def reported(self, solver: str, frequency: float) -> Response:
        """Return what the solver reports."""
        return response(self.scene, frequency, solver, self.exact)


@functools.cache
def answers() -> tuple[Answer, ...]:
    """Return the three: exact in time, the usual scheme, average acceleration with kinetic damping."""
    block = load_scene("figures-3-4").with_values({"time.step": 0.002, "fem.elements": MESH, "fem.degree": 1})
    average = block.with_values({"time.alpha": 0.25, "time.delta": 0.5, "time.gg": 0.98})
    return (
        Answer("response-exact", "exact in time", block, True),
        Answer("response-constant", "dt = 2 ms, (1/2, 1)", block),
        Answer("response-average", "dt = 2 ms, (1/4, 1/2), gg = 0.98", average),
    )


# ---- under the pressure ----


def row_name(solver: str, frequency: float) -> str:
    """Return the name of a derived row."""
    return f"{solver} at {frequency:g} Hz"


def _loaded(answer: Answer, solver: str, frequency: float, _: Finished) -> Metrics:
    """Return amplitudes under the pressure and their distance from the closed form; of elements also from the bar."""
    reported = answer.reported(solver, frequency)
    closed = answer.closed(solver, frequency)
    values: dict[str, Value] = {}
    for column, part in COLUMNS.items():
        amplitude = complex(reported.columns[column][0])
        expected = complex(getattr(closed, column)[0])
        values |= {part: abs(amplitude), f"{part}.off": abs(amplitude / expected - 1)}
        if solver == "fem":
            bar = complex(answer.reported("bar", frequency).columns[column][0])
            values[f"{part}.mesh"] = abs(amplitude) / abs(bar) - 1
    return values


def _removed(_: Finished) -> Metrics:
    """Return the share of the displacement near resonance that the step takes."""
    exact, stepped, _average = (abs(one.reported("dda", RESONANCE).columns[DISPLACEMENT][0]) for one in answers())
    return {"removed": 1 - stepped / exact}


def loaded_gates() -> Iterator[Gate]:
    """Yield the gates on responses under the pressure."""
    why = (
        "closed form at the steps' squared frequency, written apart; band: a hundred roundings, each times the "
        "conditioning of the equations there"
    )
    for answer in answers():
        for solver in ("dda", "bar"):
            for f in FREQUENCIES:
                band = float(answer.closed(solver, f).band[0])
                for part in COLUMNS.values():
                    yield gate(answer.name, row_name(solver, f), f"{part}.off", (0.0, band), why)


def mesh_gates() -> Iterator[Gate]:
    """Yield the gates on elements against the bar."""
    why = f"the error of {MESH} linear elements at this frequency, in closed form; band: rounding times conditioning"
    for answer in answers():
        for f in FREQUENCIES:
            fem = answer.closed("fem", f)
            bar = answer.closed("bar", f)
            for column, part in COLUMNS.items():
                mesh = float(abs(getattr(fem, column)[0] / getattr(bar, column)[0]) - 1)
                half = float(fem.band[0] + bar.band[0]) * (1 + abs(mesh))
                yield gate(answer.name, row_name("fem", f), f"{part}.mesh", about(mesh, half), why)


# ---- stepped on a base that vibrates ----


def steady(finished: Finished, scene: Scene, solver: str, frequency: float) -> dict[str, complex]:
    """Return the amplitudes of the last steps of a history per metre of the base's motion.

    The window holds whole periods of the record's frequencies, so that the least-squares fit of all of them, and of a
    shift, is a sum each.

    Raises
    ------
    ValueError
        There is no history.
    """
    history = finished.needed_history(scene.name, solver)
    base = read_record(Path(str(scene.load.base_motion)))
    last = slice(-WINDOWS[_record(scene)], None)
    turns = np.exp(-2j * np.pi * frequency * history.time[last])
    moved = turns @ np.interp(history.time[last], base.time, base.y)
    return {column: complex(turns @ history.columns[column][last] / moved) for column in COLUMNS}


def _record(scene: Scene) -> str:
    return scene.name.partition("[")[0]


def _stepped(scene: Scene, solver: str, frequency: float, finished: Finished) -> Metrics:
    """Return amplitudes per metre of the base, and how far from the response, of those of the record in all."""
    steady_state = steady(finished, scene, solver, frequency)
    reported = response(scene, FREQUENCIES, solver)
    values: dict[str, Value] = {}
    for column, part in COLUMNS.items():
        expected = reported.columns[column]
        difference = abs(steady_state[column] - expected[FREQUENCIES.index(frequency)]) / abs(expected).sum()
        values |= {part: abs(steady_state[column]), f"{part}.off": float(difference)}
    return values


def stepped_gates() -> Iterator[Gate]:
    """Yield the gates on steady states of stepped histories."""
    why = (
        "the response needs no step; band: what the slowest mode has left of the transients at the window's start, a "
        "rounding a step, and what the response is solved to"
    )
    for case in cases(BASE):
        for solver in SOLVERS:
            band = remaining_transients(case, solver)
            for f, part in itertools.product(FREQUENCIES, COLUMNS.values()):
                yield gate(case, row_name(solver, f), f"{part}.off", (0.0, band), why)


def remaining_transients(scene: Scene, solver: str) -> float:
    """Return what transients and rounding leave of the amplitudes of a window [-].

    A mode loses the greater modulus of its two eigenvalues a step. That falls with the frequency and rises again
    towards -1, so that the least and the greatest frequency bound it: of linear elements sqrt(12) c/h, of the block
    the determinant over the least.
    """
    E, _ = moduli(scene)
    w, h = size(scene)
    p = scene.contact.stiffness
    rho = scene.block.density
    if solver == "fem":
        ends = bar_frequency(scene), np.sqrt(12 * E / rho) * scene.fem.elements / h
    else:
        first = dda_frequency(scene)
        ends = first, np.sqrt(24 * p * E / (rho * rho * w * h * h * h)) / first
    slowest = max(max(map(abs, roots(scene, float(frequency)))) for frequency in ends)
    return float(slowest ** (scene.time.steps - WINDOWS[_record(scene)]) + scene.time.steps * EPS + SOLVED)


# ---- the damping that a step hides ----


def _hidden(frequency: float, finished: Finished) -> Metrics:
    """Return |Im W| / |W| from the block's momentum, -W2 m v = P w, in the steps and in the response."""
    (scene,) = cases(DAMPING)
    reported = {name: complex(values[0]) for name, values in response(scene, frequency, "dda").columns.items()}
    steady_state = steady(finished, scene, "dda", frequency)
    return {f"damping.{name}": ratio(parts) for name, parts in (("steps", steady_state), ("response", reported))}


def ratio(parts: Mapping[str, complex]) -> float:
    """Return |Im W| / |W| of W2 = -P w / (m v)."""
    W = np.sqrt(-parts[PRESSURE] / parts[DISPLACEMENT])
    return float(abs(W.imag) / abs(W))


def damping_gates() -> Iterator[Gate]:
    """Yield the gates on the apparent damping of the usual scheme."""
    why = "(1/2, 1): |Im W| / |W| = sin(w dt / 4) exactly; band: half of the errors of the two amplitudes"
    (scene,) = cases(DAMPING)
    w = 2 * np.pi * np.array(LOW)
    closed_form = vibration.block(scene, Stepping.of(scene).squared_frequency(w), base=True)
    for at, f in enumerate(LOW):
        exact = float(np.sin(w[at] * scene.time.step / 4))
        row = (row_name("dda", f),)
        sizes = (abs(amplitude) for amplitude in (closed_form.displacement, closed_form.contact_pressure))
        band_width = remaining_transients(scene, "dda") * sum(float(size.sum() / size[at]) for size in sizes) / 2
        yield gate(DAMPING, row, "damping.steps", about(exact, band_width), why)
        yield gate(DAMPING, row, "damping.response", about(exact, float(closed_form.band[at])), why)


# ---- viscous damping beside that of the step ----


def viscous_damping_ratio(scene: Scene) -> float:
    """Return xi of the first mode under viscous damping: it adds to what the step takes, and does not replace it.

    With W = w dt and e = dt (a0 + a1 w^2) the eigenvalues of a step are the roots of
    (1 + alpha W^2 + delta e) z^2 + [W^2 (1/2 - alpha + gg (delta - alpha)) + e (1 - 2 delta) - 1 - gg] z
    + gg + gg W^2 (1/2 - delta + alpha) - e (1 - delta).
    """
    t = scene.time
    w = dda_frequency(scene)
    W2 = (w * t.step) ** 2
    e = t.step * (scene.damping.mass + scene.damping.stiffness * w * w)
    square = 1 + t.alpha * W2 + t.delta * e
    linear = W2 * (0.5 - t.alpha + t.discount * (t.delta - t.alpha)) + e * (1 - 2 * t.delta) - 1 - t.discount
    constant = t.discount * (1 + W2 * (0.5 - t.delta + t.alpha)) - e * (1 - t.delta)
    logarithm = np.log(complex(np.roots([square, linear, constant])[0]))
    return float(-logarithm.real / abs(logarithm))


def viscous(case: Scene) -> Band:
    """Return the damping of the first mode under 5 % of viscous damping."""
    return about(viscous_damping_ratio(case), 1e-12)


# ---- the study ----


@functools.cache
def derived() -> DerivedRows:
    """Return the rows: under the pressure, of the steps, of the damping."""
    rows = []
    for answer in answers():
        for solver in ("dda", "fem", "bar"):
            rows += [_row(answer.name, solver, f, _loaded, answer, solver) for f in FREQUENCIES]
    for case in cases(BASE):
        for solver in SOLVERS:
            rows += [_row(case.name, solver, f, _stepped, case, solver) for f in FREQUENCIES]
    rows.append(Derived("response-constant", "resonance", (), _removed))
    return (*rows, *(_row(DAMPING, "dda", f, _hidden) for f in LOW))


def _row(scene: str, solver: str, frequency: float, compute: Callable[..., Any], *first: Any) -> Derived:
    needs = ((scene, solver),) if scene.startswith((BASE, DAMPING)) else ()
    return Derived(scene, row_name(solver, frequency), needs, functools.partial(compute, *first, frequency))


def gates() -> tuple[Gate, ...]:
    """Return all gates of the study."""
    return (*loaded_gates(), *mesh_gates(), *stepped_gates(), *damping_gates())


def curves() -> Mapping[str, Any]:
    """Return amplitude and phase over frequency: DDA as stepped, DDA exact in time, the continuum."""
    exact, stepped, _ = answers()
    responses = {
        "dda as stepped": stepped.reported("dda", DRAWN),  # type: ignore[arg-type]
        "dda, exact in time": exact.reported("dda", DRAWN),  # type: ignore[arg-type]
        "continuum": response(exact.scene, DRAWN, "continuum"),
    }
    drawn = []
    for name, reported in responses.items():
        curve = {"name": name, "frequency": short(DRAWN)}
        for column, values in reported.columns.items():
            size, phase = polar(values)
            curve |= {column: short(size), f"{column}_phase": short(phase)}
        drawn.append(curve)
    return {"curves": drawn}
