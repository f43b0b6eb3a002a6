"""The catalogue of metrics: what each is called, its unit, what it needs, and the function that computes it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from validation.metrics import columns, contact, growth, modes, pairs
from validation.metrics.measurable import Measurable
from validation.metrics.pairs import Pairing, relative_l2, relative_max
from validation.metrics.values import QUANTITIES, UNITS, finite
from validation.runs.history import History
from validation.runs.row import Value

HISTORY = "history"
STATIC = "static"
MODES = "modes"
DIAGNOSTICS = "diagnostics"
REFERENCE = "reference"
SWITCHES = "switches"
CONTACT = "contact"
LINEAR = frozenset({STATIC, MODES, DIAGNOSTICS})  # what a solver can report of a linear scene only


@dataclass(frozen=True)
class Metric:
    """One metric: a function of a `Measurable`, or of a `Pairing` where it needs a reference."""

    id: str
    unit: str  # "1" for a ratio
    says: str
    needs: frozenset[str]  # among history, static, modes, diagnostics, switches, contact, reference
    function: Callable[[Any], Value]
    measure: str = "history"  # the part of a study's `measures` that asks for it

    @property
    def linear(self) -> bool:
        """Whether it has a meaning for linear scenes only."""
        return bool(self.needs & LINEAR)


def _of_columns() -> Iterator[Metric]:
    of_history = frozenset({HISTORY})
    about_static = frozenset({HISTORY, STATIC})
    for name, column in QUANTITIES.items():
        parts: tuple[tuple[str, str, frozenset[str], Callable[..., Value]], ...] = (
            ("static", UNITS[name], about_static, columns.static),
            ("final", UNITS[name], of_history, columns.final),
            ("peak", UNITS[name], about_static, columns.peak),
            ("peak_time", "s", about_static, columns.peak_time),
            ("settling_step", "step", about_static, columns.settling),
            ("fine_settling_step", "step", about_static, columns.fine_settling),
            ("minimum", UNITS[name], of_history, columns.minimum),
        )
        for part, unit, needs, function in parts:
            yield Metric(f"{name}.{part}", unit, _first_line(function), needs, partial(function, column=column))
    for part, function in (("minimum_time", columns.minimum_time), ("tension_time", columns.tension_time)):
        yield Metric(f"pressure.{part}", "s", _first_line(function), of_history, function)


def _first_line(function: Callable[..., Value]) -> str:
    return (function.__doc__ or "").partition("\n")[0].removesuffix(".")


def _of_modes() -> Iterator[Metric]:
    of_operator = frozenset({MODES})
    about_static = frozenset({HISTORY, STATIC})
    parts = {
        "frequency": ("rad/s", "natural circular frequency"),
        "damping": ("1", "damping ratio of the step's operator"),
        "numerical_frequency": ("rad/s", "undamped frequency of the step's operator"),
        "spectral_radius": ("1", "largest modulus of the operator's eigenvalues"),
        "least_root": ("1", "real part of the eigenvalue nearest to -1"),
    }
    for part in ("frequency", "damping", "numerical_frequency", "spectral_radius"):
        unit, says = parts[part]
        function = partial(modes.first_axial, part=part)
        yield Metric(f"mode1.{part}", unit, f"first axial mode: {says}", of_operator, function, "modes")
    for part in ("frequency", "damping"):
        says = f"{part} of the displacement's strongest oscillation"
        function = partial(modes.measured, part=part)
        yield Metric(f"mode1.measured_{part}", parts[part][0], says, about_static, function, "modes")
    for part in ("frequency", "damping", "spectral_radius", "least_root"):
        unit, says = parts[part]
        function = partial(modes.contact, part=part)
        yield Metric(f"contact.{part}", unit, f"contact mode: {says}", of_operator, function, "modes")


def _of_stability() -> Iterator[Metric]:
    of_diagnostics = frozenset({DIAGNOSTICS})
    for name, key, says in (
        ("radius", "predicted_radius", "spectral radius in closed form"),
        ("radius_seen", "spectral_radius", "spectral radius of the step itself"),
        ("condition", "condition_number", "condition number of the step's matrix"),
        ("residual", "scaled_residual", "scaled residual of one solution"),
        ("omega", "largest_omega", "largest w dt"),
    ):
        yield Metric(f"stability.{name}", "1", says, of_diagnostics, partial(growth.diagnosed, key=key), "stability")
    rate = "growth factor per step of an unstable run"
    yield Metric("stability.growth", "1", rate, frozenset({HISTORY}), growth.growth_of_run, "stability")
    largest = "largest w dt without growth (stability limit)"
    yield Metric("stability.limit", "1", largest, of_diagnostics, growth.limit, "limit")
    change = "largest relative change of a mode's energy over the run"
    yield Metric("energy.drift", "1", change, frozenset({HISTORY, STATIC, MODES}), growth.drift, "energy")


def _of_switches() -> Iterator[Metric]:
    of_switches = frozenset({SWITCHES})
    yield Metric("switches.count", "1", "openings and closings after t = 0", of_switches, contact.count, "switches")
    for part, opens in (("first_opening", True), ("first_closing", False)):
        says = f"time of the {part.replace('_', ' ')} after t = 0"
        yield Metric(f"switches.{part}", "s", says, of_switches, partial(contact.first, opens=opens), "switches")
    for part, opens in (("second_opening", True), ("second_closing", False)):
        says = f"time of the {part.replace('_', ' ')} after t = 0, corners that switch together as one"
        yield Metric(f"switches.{part}", "s", says, of_switches, partial(contact.second, opens=opens), "switches")
    for name, unit, says, function in contact.parts():
        yield Metric(name, unit, says, frozenset({CONTACT}), partial(contact.reported, part=function), "switches")
    changes = _first_line(contact.state_changes)
    yield Metric("contact.state_changes", "1", changes, frozenset({HISTORY}), contact.state_changes, "switches")
    says = _first_line(contact.horizon)
    yield Metric("horizon.time", "s", says, frozenset({HISTORY, SWITCHES}), contact.horizon, "horizon")


KIND = Metric(
    "stability.kind",
    "word",
    "stability of the run: stable, marginal, unstable or overflow",
    frozenset({DIAGNOSTICS}),
    growth.kind_of_run,
    "stability",
)  # a word, which no gate can bound


def _of_pairs() -> Iterator[Metric]:
    both = frozenset({HISTORY, REFERENCE})
    for name in QUANTITIES:
        for part, function in (("l2", relative_l2), ("max", relative_max)):
            says = f"{'root mean square' if part == 'l2' else 'maximum'} error of the {name} over that of the reference"
            yield Metric(f"{name}.{part}", "1", says, both, partial(pairs.compared, quantity=name, function=function))
    for name in QUANTITIES:
        says = f"maximum error of the {name} over the larger of the reference's maximum and the static value"
        yield Metric(f"{name}.scaled", "1", says, both | {STATIC}, partial(pairs.scaled, quantity=name))
    yield Metric("worst.max", "1", "the larger of displacement.max and pressure.max", both, pairs.worst)


COUNTS = frozenset({"switches.count", "contact.state_changes"})  # beside all that are measured in steps
SOLO = {metric.id: metric for metric in (*_of_columns(), *_of_modes(), *_of_stability(), *_of_switches())}
PAIRS = {metric.id: metric for metric in _of_pairs()}
CATALOGUE = SOLO | PAIRS


def is_count(metric: str) -> bool:
    """Whether a metric counts something: its zero is none, and not a small number."""
    entry = CATALOGUE.get(metric)
    return metric in COUNTS or (entry is not None and entry.unit == "step")


def measured_by(measures: Collection[str], only: Collection[str] | None = None) -> list[Metric]:
    """Return the metrics of one run that the parts of a study's `measures` ask for, or those of them that are named."""
    metrics = [metric for metric in (*SOLO.values(), KIND) if metric.measure in measures]
    return metrics if only is None else [metric for metric in metrics if metric.id in only]


def solo(
    m: Measurable, measures: Collection[str] = ("history", "modes"), only: Collection[str] | None = None
) -> dict[str, Value]:
    """Return the metrics of one run that are asked for; none of them is ever NaN."""
    with np.errstate(all="ignore"):
        return {metric.id: finite(metric.function(m)) for metric in measured_by(measures, only)}


def pair(metric: str, history: History, reference: History, run: Mapping[str, Value] | None = None) -> Value:
    """Return a metric between a run and its reference, on their common steps.

    Parameters
    ----------
    metric
        An id of `PAIRS`.
    history, reference
        The run and what it is compared with.
    run
        Metrics of the run, for the static values of `.scaled`.
    """
    return PAIRS[metric].function(Pairing(history, reference, run or {}))
