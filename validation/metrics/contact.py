"""Metrics of a contact that opens and closes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from validation.metrics.measurable import Measurable
from validation.metrics.values import NOT_REPORTED, UNDEFINED, largest
from validation.runs.contact import LOST, LOST_AT_IMPACTS, STORED, ContactRecord
from validation.runs.history import Array
from validation.runs.row import Value

SHIFT = 1e-12  # relative change of springs or density that stands for another code, well above the rounding of any
AGREED = 1e-6  # of the maximum: what two correct codes of one model keep as long as rounding is not amplified
Part = Callable[[ContactRecord], Value]


def count(m: Measurable) -> Value:
    """Openings and closings after t = 0, of all corners."""
    return NOT_REPORTED if m.switches is None else float(sum(switch.opens is not None for switch in m.switches))


def first(m: Measurable, opens: bool) -> Value:
    """Time of the first opening, or of the first closing, after t = 0 [s]; undefined where there is none."""
    if m.switches is None:
        return NOT_REPORTED
    return next((switch.time for switch in m.switches if switch.opens is opens), UNDEFINED)


def second(m: Measurable, opens: bool) -> Value:
    """Time at which a corner opens, or closes, again [s]; corners that switch together count as one."""
    if m.switches is None:
        return NOT_REPORTED
    times = sorted({switch.time for switch in m.switches if switch.opens is opens})
    return times[1] if len(times) > 1 else UNDEFINED


def state_changes(m: Measurable) -> Value:
    """Changes of state from step to step, open, stick and slip either way, of both corners; from their columns."""
    states = [m.history.columns.get(name) for name in ("state_m", "state_n")]
    if any(state is None for state in states):
        return NOT_REPORTED
    return float(sum(np.count_nonzero(np.diff(state)) for state in states if state is not None))


def reported(m: Measurable, part: Part) -> Value:
    """Return a part of what the contact did, not reported where there is no record."""
    return NOT_REPORTED if m.contact is None or not len(m.contact.time) else part(m.contact)


def reduced(record: ContactRecord, column: str, how: str) -> Value:
    """Return the last value of a column, or its largest, its mean or its sum."""
    values = getattr(record, column)
    if values is None:
        return NOT_REPORTED
    return float(values[-1] if how == "last" else getattr(values, how)()) + 0.0


def open_share(record: ContactRecord) -> Value:
    """Share of the time that the corners are open."""
    return float(np.average(record.open_share, weights=np.diff(record.time, prepend=0.0)))


def rare_solves(record: ContactRecord) -> Value:
    """Solves of the open-close iteration that one step in a hundred exceeds."""
    if record.solves is None:
        return NOT_REPORTED
    return float(np.percentile(record.solves, 99, method="inverted_cdf"))


def restitution(record: ContactRecord) -> Value:
    """Greatest speed of the centre of mass upwards in flight after the first landing over its speed before it."""
    if record.velocity is None:
        return NOT_REPORTED
    before, after = landing(record)
    if not (before < 0 and len(after)):
        return UNDEFINED
    return max(0.0, float(np.max(after))) / -before


def landing(record: ContactRecord) -> tuple[float, Array]:
    """Return the velocity before the first landing, zero where there is none, and those in flight after it [m/s].

    The first landing is the first step with a contact force.
    """
    pressed = record.force > 0
    if record.velocity is None or not pressed.any():
        return 0.0, np.zeros(0)
    first = int(np.argmax(pressed))
    before = record.start_velocity if first == 0 else float(record.velocity[first - 1])
    return before, record.velocity[first:][~pressed[first:]]


def of_rebounds(record: ContactRecord, part: str) -> Value:
    """Return the restitution of single contacts: the first, their mean or the greatest.

    Undefined where none begins and ends in the run.
    """
    if record.rebounds is None:
        return NOT_REPORTED
    restitutions = [rebound.restitution for rebound in record.rebounds if rebound.restitution is not None]
    if not restitutions:
        return UNDEFINED
    return {"first": restitutions[0], "mean": float(np.mean(restitutions)), "most": max(restitutions)}[part]


def slip_rate(record: ContactRecord) -> Value:
    """Slip per second over the second half of the run."""
    if record.slip is None:
        return NOT_REPORTED
    half = len(record.time) // 2
    passed = float(record.time[-1] - record.time[half])
    return float(record.slip[-1] - record.slip[half]) / passed if passed > 0 else UNDEFINED


def landing_speed(record: ContactRecord) -> Value:
    """Greatest rate at which a gap closes before a contact."""
    if record.rebounds is None:
        return NOT_REPORTED
    return max((rebound.closing for rebound in record.rebounds), default=UNDEFINED)


def stored(record: ContactRecord, name: str) -> Value:
    """Return an energy at the last step, or what was lost by then."""
    return float(record.energies[name][-1]) if name in record.energies else NOT_REPORTED


def total(record: ContactRecord) -> Array | None:
    """Return the total energy at each step [J]; None where it is not reported."""
    if not set(STORED) <= set(record.energies):
        return None
    return np.asarray(sum(record.energies[name] for name in STORED), dtype=np.float64)


def input_energy(record: ContactRecord) -> Value:
    """Kinetic energy at the start and what the loads put in until they stand still."""
    return record.input_energy


def rise(record: ContactRecord) -> Value:
    """Greatest total energy above that at the start, over what start and loads give."""
    energy = total(record)
    if energy is None:
        return NOT_REPORTED
    return (
        max(0.0, float(energy.max()) - record.start_energy) / record.input_energy if record.input_energy else UNDEFINED
    )


def switching(record: ContactRecord) -> Value:
    """Energy gained by opening and closing, negative where lost, over that of start and loads."""
    lost = record.energies.get(LOST[2])
    if lost is None:
        return NOT_REPORTED
    return -float(lost[-1]) / record.input_energy if record.input_energy else UNDEFINED


def imbalance(record: ContactRecord) -> Value:
    """Largest defect of the energy balance, stored + lost = start, over the largest energy in it."""
    energy = total(record)
    losses = [name for name in LOST if name in record.energies or name != "friction"]  # without friction: not reported
    losses += [name for name in LOST_AT_IMPACTS if name in record.energies]
    if energy is None or not set(losses) <= set(record.energies):
        return NOT_REPORTED
    parts = [record.energies[name] for name in (*STORED, *losses)]
    size = max(record.start_energy, *map(largest, parts))
    defect = energy - record.start_energy + sum(record.energies[name] for name in losses)
    return largest(defect) / size if size else UNDEFINED


def horizon(m: Measurable) -> Value:
    """Time up to which a run with p (1 + 1e-12) agrees to 1e-6 of the maxima: no two codes need agree longer [s]."""
    shadow = m.shadow() if m.shadow is not None else None
    if shadow is None or not len(m.history.time):
        return NOT_REPORTED
    n = min(len(shadow.time), len(m.history.time))
    disagrees = np.zeros(n, bool)
    for name, values in m.history.columns.items():
        if name in ("displacement", "contact_pressure") and name in shadow.columns:
            disagrees |= ~(np.abs(values[:n] - shadow.columns[name][:n]) <= AGREED * largest(values))
    agreed_steps = int(np.argmax(disagrees)) if disagrees.any() else n
    return float(m.history.time[agreed_steps - 1]) if agreed_steps > 0 else 0.0
