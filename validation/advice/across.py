"""The adviser across schemes: which of them, at which step, has a damping ratio at a frequency, and at what price.

Damping ratios are those of the roots of a step (`theory.stepping`), rebounds those of a rigid mass on a spring
(`theory.rebound`). The step of a scheme is the smallest at which xi reaches the target; the families of one parameter
are asked at the present step too.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from validation.advice import overshoot
from validation.advice.coarse import closed
from validation.advice.limits import Limit, check_ratio
from validation.advice.plain import PlainAnswer
from validation.advice.spectra import dda_modes, highest_frequency, number, rate_of
from validation.advice.words import say
from validation.errors import InputError
from validation.runs.modes import Mode
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.theory import landing
from validation.theory.rebound import ReboundStatistics, rebound_statistics, spring_steps
from validation.theory.stages import Stages
from validation.theory.stepping import Stepping

LADDER = {  # scheme -> values of rho_inf that are offered; wbz at 0 and hht at 1/2 are chung-hulbert at 0 and 1/2
    "chung-hulbert": (0.0, 0.5, 0.8),
    "hht": (0.8,),
    "wbz": (0.5,),
    "composite": (0.0, 0.5),
}
CONSTANT = (0.5, 1.0)  # (alpha, delta), offered beside the scene's own
AVERAGE = (0.25, 0.5)
OMEGAS = np.geomspace(1e-5, 30.0, 400)  # w dt between which a step is looked for
RESOLVED = 0.1  # w dt at which average acceleration follows a frequency to a thousandth; its damping is gg's
OTHERS = (0.2, 1.0, 5.0)  # times the requested frequency, at which damping is told too
IMPACTS = (0.1, 0.3, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 30.0, 100.0, 1e3, 1e5)  # w_c dt at which rebounds are looked at
LEAST_IMPACT = 0.05  # w_c dt below which a contact is followed in so many steps that its rebound is that of this one
LEAST_RATIO = 1e-5  # of critical damping
STEPS = 8  # of a period of the requested frequency, below which a scheme is not recommended
GAIN = 1e-3  # of the speed: what a rebound may have above 1
LATE = 0.02  # of a period, by which one that is told is off
KEEPS = 0.9  # modulus from which on a contact mode counts as hardly damped


@dataclass(frozen=True)
class Offer:
    """A scheme at a step that has the wanted damping ratio."""

    name: str
    settings: dict[str, Any]  # for Scene.with_values
    step: float  # dt [s]
    gg: float  # per step
    damping: float  # xi at the requested frequency [-]
    period_error: float  # there [-]
    hidden: dict[str, float | None]  # frequency [Hz] -> xi; None where no pair of roots oscillates
    first_mode: float | None  # xi of the block's first axial mode
    contact_mode: float | None  # xi of its highest mode, the contact's where p is large
    contact_radius: float  # and the share of its amplitude that a step keeps
    cost: float | None  # linear solves a second over those of the scene; None where that has none
    rebound: dict[str, float]  # of its contact at this step, without the discount: mean, least, most [-]
    greatest_rebound: float  # at any step [-]
    gains: bool  # whether an impact at this step may give back more than it had
    start_rise: float | None  # energy that the first step adds from a consistent start, over what the loads give [-]
    fears: tuple[str, ...]


@dataclass(frozen=True)
class SchemeAdvice(PlainAnswer):
    """The offers, the recommended first, and one sentence."""

    scene: str
    target: float  # xi [-]
    frequency: float  # at which it is wanted [Hz]
    no_gain: bool  # whether impacts must not gain energy
    offers: tuple[Offer, ...]
    unreachable: dict[str, float]  # scheme -> the largest xi that it has there
    sentence: str


def advise_across(
    scene: Scene, damping: float, frequency: float | None = None, no_gain: bool | None = None
) -> SchemeAdvice:
    """Return the schemes that have a damping ratio at a frequency, each at its own step, the recommended first.

    Recommended are first those whose impacts gain nothing, where that is wanted; then those whose first step adds no
    energy, where the scene starts consistently; then those with eight steps in a period of the frequency; then those
    without a discount, which is a drag in flight and in sliding; then those with the fewest linear solves.

    Parameters
    ----------
    scene
        A scene without a sweep, of one block.
    damping
        Target xi [-].
    frequency
        At which it is wanted [Hz]; that of the block's first axial mode if absent.
    no_gain
        Whether impacts must not gain energy; if absent, where the scene's contact opens.

    Raises
    ------
    InputError
        The target or the frequency is out of its range, or the scene has damping tables.

    Examples
    --------
    >>> from validation import advise_across, load_scene
    >>> advice = advise_across(load_scene("field-locked"), damping=0.05, frequency=5.0)
    >>> advice.offers[0].name, round(1e3 * advice.offers[0].step, 2)
    ('chung-hulbert (rho_inf = 0)', 19.06)
    """
    check_ratio(damping, LEAST_RATIO)
    Limit("frequency").check(frequency)
    features.refuse_damping(scene, "advise")
    # a block whose contact stays closed has modes; one that opens must be a rectangle on springs
    features.refuse_column(scene, "advise")
    is_known = scene.block.rectangle is not None and math.isfinite(scene.contact.stiffness)
    if scene.contact.law == "unilateral" and not is_known:
        rule = "must be a rectangle on springs of finite stiffness where contact opens"
        raise InputError(rule, source=scene.name, advice="state contact.stiffness, or lock the contact")
    block = closed(scene)
    modes = dda_modes(block)
    highest = highest_frequency(block)
    impact = highest if scene.block.rectangle is None else landing.contact_frequency(scene)
    hertz = modes[0].frequency / (2 * math.pi) if frequency is None else float(frequency)
    wish = scene.contact.law == "unilateral" if no_gain is None else no_gain
    steppings, unreachable = _candidates(scene, float(damping), 2 * math.pi * hertz)
    offers = [_offer(scene, 2 * math.pi * hertz, modes, highest, impact, stepping) for stepping in steppings]
    starts = scene.time.start == "consistent" and scene.load.ramp == 0

    def rank(offer: Offer) -> tuple[bool, bool, bool, bool, float]:
        steps_of_a_period = 1 / (hertz * offer.step)
        is_raised = starts and (offer.start_rise or 0.0) > overshoot.NOTABLE
        return wish and offer.gains, is_raised, steps_of_a_period < STEPS, offer.gg < 1, offer.cost or 0.0

    ranked = sorted(offers, key=rank)
    answer = SchemeAdvice(scene.name, float(damping), hertz, wish, tuple(ranked), unreachable, "")
    return replace(answer, sentence=_sentence(answer))


# ---- candidates ----


def _candidates(scene: Scene, target: float, omega: float) -> tuple[list[Stepping], dict[str, float]]:
    """Return the steps that have the target, and by name the largest xi of the schemes that have it nowhere."""
    present = Stepping.of(scene)
    weights = [CONSTANT, (present.alpha, present.delta)] if present.scheme == "newmark" else [CONSTANT]
    units = [Stepping(1.0, alpha, delta) for alpha, delta in dict.fromkeys(weights) if delta > 0.5]
    for scheme, radii in LADDER.items():
        units += [Stepping.named(scheme, rho_inf=radius) for radius in radii]
    steppings: list[Stepping] = []
    unreachable: dict[str, float] = {}
    for unit in units:
        ratios = _ratios(unit)
        if not np.any(ratios >= target):
            unreachable[_named(unit)] = float(np.nanmax(ratios))
            continue
        i = int(np.argmax(ratios >= target))
        W = _root(unit.damping_ratio, target, OMEGAS[max(i - 1, 0)], OMEGAS[i])
        steppings.append(unit.at(float(OMEGAS[i] if W is None else W) / omega))
    unreachable["leapfrog"] = 0.0  # which damps nothing
    # Families of one parameter, at the present step; average acceleration damps nothing of its own, so that a rate of
    # gg is all there is: xi = c / (2 w).
    short = min(present.step, RESOLVED / omega)
    families: list[tuple[Callable[[float], Stepping], float, float]] = [
        (lambda delta: Stepping(present.step, (0.5 + delta) ** 2 / 4, delta), 0.5, 1.5)
    ]
    for scheme in LADDER:
        member = functools.partial(_of_radius, scheme, present.step)
        families.append((member, 0.5 if scheme == "hht" else 0.0, 1.0))
    discounted = functools.partial(Stepping, short, *AVERAGE)
    families.append((discounted, math.exp(-4 * target * omega * short), 1.0))
    for family, low, high in families:

        def ratio(value: float, family: Callable[[float], Stepping] = family) -> float:
            stepping = family(value)
            return stepping.damping_ratio(omega * stepping.step)

        value = _root(ratio, target, low, high)
        listed = LADDER.get(family(high).scheme, ())
        if value is not None and all(abs(value - radius) > 1e-6 for radius in listed):
            steppings.append(family(value))
    return steppings, unreachable


def _of_radius(scheme: str, step: float, radius: float) -> Stepping:
    return Stepping.named(scheme, step, rho_inf=radius)


@functools.lru_cache(maxsize=64)
def _ratios(unit: Stepping) -> Any:
    """Return xi over `OMEGAS`, of which not a number is never reached."""
    return np.array([unit.damping_ratio(float(W)) for W in OMEGAS])


def _root(ratio: Callable[[float], float], target: float, low: float, high: float) -> float | None:
    """Return where a function has the target between two ends; None where they do not bracket it."""
    from scipy.optimize import brentq

    ends = [ratio(end) - target for end in (low, high)]
    if not all(map(math.isfinite, ends)) or ends[0] * ends[1] > 0:
        return None
    return float(brentq(lambda value: ratio(value) - target, low, high, xtol=1e-15, rtol=1e-14))


def _named(stepping: Stepping) -> str:
    name = say("newmark" if stepping.scheme == "newmark" else "of one number", stepping)
    return name if stepping.gg == 1 else say("with gg", stepping, name=name)


# ---- one offer ----


def _offer(
    scene: Scene, omega: float, modes: tuple[Mode, ...], highest: float, impact: float, stepping: Stepping
) -> Offer:
    dt = stepping.step
    present = Stepping.of(scene)
    settings: dict[str, Any] = {"time.step": dt, "time.gg": stepping.gg}
    if stepping.scheme != "newmark":
        settings |= {"time.scheme": stepping.scheme, "time.rho_inf": stepping.rho_inf}
    else:
        settings |= {"time.alpha": stepping.alpha, "time.delta": stepping.delta}
        settings |= {} if present.scheme == "newmark" else {"time.scheme": "newmark"}
    rebound = rebound_of(stepping.stages, min(max(impact * dt, LEAST_IMPACT), IMPACTS[-1]))
    ratios = {share * omega: number(stepping.damping_ratio(share * omega * dt)) for share in OTHERS}
    offer = Offer(
        name=_named(stepping),
        settings=settings,
        step=dt,
        gg=stepping.gg,
        damping=stepping.damping_ratio(omega * dt),
        period_error=stepping.period_error(omega * dt),
        hidden={f"{frequency / (2 * math.pi):.6g}": ratio for frequency, ratio in ratios.items()},
        first_mode=number(stepping.damping_ratio(modes[0].frequency * dt)),
        contact_mode=number(stepping.damping_ratio(highest * dt)),
        contact_radius=stepping.spectral_radius(highest * dt),
        cost=stepping.solves / dt / (present.solves / present.step) if present.solves else None,
        rebound={"mean": rebound.mean, "least": rebound.least, "most": rebound.most},
        greatest_rebound=max(rebound_of(stepping.stages, W).most for W in IMPACTS),
        gains=rebound.most > 1 + GAIN,
        start_rise=overshoot.rise_of(stepping, modes),
        fears=(),
    )
    steps = 2 * math.pi / (omega * dt)
    fears = {
        "gains": offer.gains,
        "gains elsewhere": not offer.gains and offer.greatest_rebound > 1 + GAIN,
        "raises": (offer.start_rise or 0.0) > overshoot.NOTABLE,
        "rings": offer.contact_radius > KEEPS,
        "drags": offer.gg < 1,
        "no oscillation": offer.first_mode is None,
        "damps the first mode": (offer.first_mode or 0.0) > 2 * offer.damping,
        "period too long": offer.period_error > LATE,
        "period too short": offer.period_error < -LATE,
        "few steps": steps < STEPS,
    }
    words = {"drag": rate_of(offer.gg, dt), "late": abs(offer.period_error), "steps": steps}
    return replace(offer, fears=tuple(say(name, offer, **words) for name, is_feared in fears.items() if is_feared))


@functools.lru_cache(maxsize=4096)
def rebound_of(stages: Stages, omega: float) -> ReboundStatistics:
    """Return the rebound of a rigid mass at W = w_c dt, to which a discount adds nothing."""
    return rebound_statistics(spring_steps(stages, omega))


def _sentence(advice: SchemeAdvice) -> str:
    wish = say("wish without gain" if advice.no_gain else "wish", advice)
    fitting = [offer for offer in advice.offers if not (advice.no_gain and offer.gains)]
    if not fitting:
        return say("all gain" if advice.offers else "no scheme", wish)
    return say("schemes", wish, ", or ".join(say("scheme", offer) for offer in fitting[:2]))
