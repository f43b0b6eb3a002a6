"""Alarms of contact that opens.

step too large for contact
    The step changes the restitution of a landing by more than a tenth; arbitrary where it is the phase that decides.
energy gained by switching
    Opening and closing have put energy into the block.
energy may be gained
    delta < 1 or 2 alpha < delta, with w_c dt > 1: nothing keeps opening and closing from putting energy in.
hidden opening
    The step is too long to see that the block leaves its springs.
peak force of the penalty
    The peak of the contact force is that of the springs, which grows as sqrt(p), not that of the body.
drag in flight
    gg < 1 brakes the block in the air as well.
tension of a dead band
    The band lets a contact that carries no tension pull with more than 1 % of the load.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from validation.advice import contact
from validation.advice.alarm import Alarm
from validation.runs.row import Row
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.contract import Role
from validation.solvers.registry import by_role
from validation.theory import landing
from validation.theory.stepping import Stepping

LARGE_STEP = "step too large for contact"
GAINED = "energy gained by switching"
MAY_GAIN = "energy may be gained"
HIDDEN = "hidden opening"
PENALTY = "peak force of the penalty"
DRAG = "drag in flight"
PULLING = "tension of a dead band"
KINDS = (LARGE_STEP, GAINED, MAY_GAIN, HIDDEN, PENALTY, DRAG, PULLING)
NOTABLE = 0.01  # of the energy given, or of the load
BEYOND = 1.5  # times the peak force of the exact bar from which on a peak is the springs'


def contact_alarms(scene: Scene, rows: Mapping[str, Row]) -> Iterator[Alarm]:
    """Yield the alarms of the judged method's run of a scene with unilateral contact.

    Parameters
    ----------
    scene
        The scene.
    rows
        Its finished rows by solver.
    """
    name = next((name for name in by_role(Role.JUDGED) if name in rows), None)
    if name is None or features.UNILATERAL not in features.of(scene):
        return
    run = ContactRun(scene, rows[name], next((rows[n] for n in by_role(Role.TRUTH) if n in rows), None))
    for alarm in (_large_step, _gained, _may_gain, _hidden, _penalty, _drag, _pulling):
        yield from alarm(run)


class ContactRun:
    """A run of the judged method, with the exact one where there is one."""

    def __init__(self, scene: Scene, row: Row, truth: Row | None) -> None:
        self.scene = scene
        self.row = row
        self.truth = truth
        self.omega = contact.omega(scene)
        lands = _number(row, "switches.first_closing") is not None or scene.block.velocity < 0
        self.opens = (_number(row, "contact.gap") or 0.0) > 0  # and, of what lands:
        self.returns = self.opens and lands

    def alarm(self, kind: str, sentence: str, **values: float) -> Alarm:
        """Return an alarm on this run."""
        return Alarm(kind, self.scene.name, sentence, {k: v for k, v in values.items() if math.isfinite(v)})


def _number(row: Row | None, metric: str) -> float | None:
    value = None if row is None else row.metrics.get(metric)
    return value if isinstance(value, float) else None


def _large_step(run: ContactRun) -> Iterator[Alarm]:
    if not run.returns:
        return
    landed = contact.restitution(run.scene)
    if landed is None or landed.error <= contact.NOTABLE:
        return
    arbitrary = landed.high - landed.low > contact.NOTABLE
    by_phase = ", by where in the step the block lands" if arbitrary else ""
    sentence = (
        f"w_c dt = {run.omega:.3g}: an unloaded landing leaves the centre of mass {landed.low:.2g} to "
        f"{landed.high:.2g} of its speed{by_phase}; without a time step {landed.own:.3g}"
    )
    yield run.alarm(
        LARGE_STEP,
        sentence,
        omega=run.omega,
        low=landed.low,
        mean=landed.mean,
        high=landed.high,
        own=landed.own,
    )


def _gained(run: ContactRun) -> Iterator[Alarm]:
    gain = _number(run.row, "energy.switching_gain")
    if gain is not None and gain > NOTABLE:
        sentence = f"opening and closing have added {100 * gain:.3g} % to the energy that start and loads give"
        yield run.alarm(GAINED, sentence, gain=gain)


def _may_gain(run: ContactRun) -> Iterator[Alarm]:
    stepping = Stepping.of(run.scene)
    if run.returns and run.omega > 1 and not landing.cannot_gain(run.scene):
        sentence = (
            f"{stepping.numbers} with w_c dt = {run.omega:.3g}: opening and closing can add "
            'energy; they cannot with delta >= 1 and 2 alpha >= delta, nor with contact.rule = "implicit" or '
            '"energy-conserving"'
        )
        yield run.alarm(MAY_GAIN, sentence, omega=run.omega, alpha=stepping.alpha, delta=stepping.delta)


def _hidden(run: ContactRun) -> Iterator[Alarm]:
    limit = landing.hidden_from(run.scene)
    if limit is not None and run.scene.time.step > limit:
        sentence = (
            f"dt = {run.scene.time.step:g} s is beyond {limit:.4g} s, h / (c sqrt(6 alpha)): the block of one strain "
            "leaves its springs at t = 0, and no step shows it"
        )
        yield run.alarm(HIDDEN, sentence, step=run.scene.time.step, limit=limit)


def _penalty(run: ContactRun) -> Iterator[Alarm]:
    peak, exact = (_number(row, "contact.peak_force") for row in (run.row, run.truth))
    quarter = landing.quarter_mass_force(run.scene, 1.0)
    stiff = quarter > landing.wave_force(run.scene, 1.0)
    if peak is not None and exact and stiff and peak > BEYOND * exact:
        factor = landing.impact_force(run.scene, 1.0) / quarter
        landed = f", {factor:.3g} V sqrt(p m / 2) for an unloaded landing at V" if math.isfinite(factor) else ""
        sentence = (
            f"the peak contact force, {peak:.3g} N, is {peak / exact:.2g} times that of the exact bar: it is that of "
            f"the springs{landed}, and grows as sqrt(p)"
        )
        yield run.alarm(PENALTY, sentence, peak=peak, bar=exact)


def _drag(run: ContactRun) -> Iterator[Alarm]:
    t = run.scene.time
    share = _number(run.row, "contact.open_share") or 0.0
    if t.discount < 1 and share > 0:
        constant = -t.step / math.log(t.discount) if t.discount > 0 else 0.0
        sentence = (
            f"gg = {t.discount:g} slows the block in flight as well, {100 * share:.3g} % of the time: speeds fall "
            f"with the time constant {constant:.3g} s, -dt / ln(gg)"
        )
        yield run.alarm(DRAG, sentence, gg=t.discount, share=share, constant=constant)


def _pulling(run: ContactRun) -> Iterator[Alarm]:
    scene = run.scene
    tension = 2 * scene.contact.stiffness * scene.contact.band[1] if scene.contact.band[1] else 0.0
    load = abs(opened.resultant_load(scene)) or landing.impact_force(scene, scene.block.velocity)
    if tension > NOTABLE * load:
        share = f", {100 * tension / load:.3g} % of the load" if load else ""
        yield run.alarm(PULLING, f"the band lets the contact pull with up to {tension:.3g} N{share}", pull=tension)
