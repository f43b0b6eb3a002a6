"""The adviser across schemes: which of them, at which step, has a damping ratio at a frequency, and at what price.

Damping ratios are those of the roots of a step (`theory.stepping`), rebounds those of a rigid mass on a spring
(`theory.rebound`). Of each scheme the step is taken at which xi first reaches the target, from small steps on; the
families of one parameter are asked at the present step too.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from validation.advice import overshoot
from validation.advice.advice import LARGEST_RATIO
from validation.advice.coarse import closed
from validation.advice.limits import Limit
from validation.advice.plain import PlainAnswer
from validation.advice.spectra import dda_modes, highest_frequency, percent
from validation.errors import InputError
from validation.runs.modes import Mode
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.theory import landing, spectra
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
    if not (isinstance(damping, int | float) and LEAST_RATIO <= damping <= LARGEST_RATIO):
        rule = f"must be a damping ratio from {LEAST_RATIO:g} to {LARGEST_RATIO:g}"
        advice = f"{damping:g} % is {damping / 100:g}" if damping > LARGEST_RATIO else None
        raise InputError(rule, field="damping", value=f"{damping:g}", advice=advice)
    Limit("frequency").check(frequency)
    features.refuse_damping(scene, "advise")
    frequencies = _block_frequencies(scene)
    hertz = frequencies.first / (2 * math.pi) if frequency is None else float(frequency)
    wish = scene.contact.law == "unilateral" if no_gain is None else no_gain
    describe = functools.partial(_offer, scene, 2 * math.pi * hertz, frequencies)
    offers = []
    unreachable: dict[str, float] = {}
    for name, settings, stepping, largest in _candidates(scene, float(damping), 2 * math.pi * hertz):
        if stepping is None:
            unreachable[name] = largest
        else:
            back = {"time.scheme": "newmark"} if stepping.scheme == "newmark" != scene.time.scheme else {}
            offers.append(describe(name, back | settings, stepping))

    starts = scene.time.start == "consistent" and scene.load.ramp == 0

    def rank(offer: Offer) -> tuple[bool, bool, bool, bool, float]:
        steps_of_a_period = 1 / (hertz * offer.step)
        is_raised = starts and (offer.start_rise or 0.0) > overshoot.NOTABLE
        return wish and offer.gains, is_raised, steps_of_a_period < STEPS, offer.gg < 1, offer.cost or 0.0

    ranked = sorted(offers, key=rank)
    answer = SchemeAdvice(scene.name, float(damping), hertz, wish, tuple(ranked), unreachable, "")
    return replace(answer, sentence=_sentence(answer))


@dataclass(frozen=True)
class BlockFrequencies:
    """What a block on its springs vibrates at [rad/s]."""

    first: float  # its first axial mode, contact closed
    highest: float  # its highest mode, the contact's where p is large
    impact: float  # pi over the duration of a landing
    modes: tuple[Mode, ...]  # contact closed


def _block_frequencies(scene: Scene) -> BlockFrequencies:
    """Return the frequencies of a block; of one that opens as of a rectangle with mu = 0 whose contact is closed."""
    features.refuse_column(scene, "advise")
    if scene.contact.law == "unilateral":
        if scene.block.rectangle is None or not math.isfinite(scene.contact.stiffness):
            rule = "must be a rectangle on springs of finite stiffness where contact opens"
            raise InputError(rule, source=scene.name, advice="state contact.stiffness, or lock the contact")
        impact = landing.contact_frequency(scene)
        modes = dda_modes(closed(scene))
        return BlockFrequencies(spectra.dda_frequency(scene), spectra.contact_frequency(scene), impact, modes)
    highest = highest_frequency(scene)
    impact = highest if scene.block.rectangle is None else landing.contact_frequency(scene)
    modes = dda_modes(scene)
    return BlockFrequencies(modes[0].frequency, highest, impact, modes)


# ---- candidates -----------------------------------------------------------------------------------------------------

Candidate = tuple[str, dict[str, Any], Stepping | None, float]


def _candidates(scene: Scene, target: float, omega: float) -> Iterator[Candidate]:
    """Yield name, settings and stepping of what has the target; None with the largest xi of what has it nowhere."""
    present = Stepping.of(scene)
    weights = [(present.alpha, present.delta)] if present.scheme == "newmark" else []
    for alpha, delta in dict.fromkeys([CONSTANT, *weights]):
        if delta > 0.5:
            newmark = Stepping(1.0, alpha, delta)
            yield _at_its_step(newmark, {"time.alpha": alpha, "time.delta": delta}, target, omega)
    for scheme, radii in LADDER.items():
        for radius in radii:
            stepping = Stepping.named(scheme, rho_inf=radius)
            yield _at_its_step(stepping, {"time.scheme": scheme, "time.rho_inf": radius}, target, omega)
    yield "leapfrog", {}, None, 0.0  # which damps nothing
    yield from _at_the_present_step(present.step, target, omega)
    # average acceleration damps nothing of its own, so that a rate of gg is all there is: xi = c / (2 w)
    step = min(present.step, RESOLVED / omega)
    least = math.exp(-4 * target * omega * step)
    gg = _root(lambda value: Stepping(step, *AVERAGE, gg=value).damping_ratio(omega * step), target, least, 1.0)
    if gg is not None:
        settings = {"time.alpha": 0.25, "time.delta": 0.5, "time.step": step, "time.gg": gg}
        yield _named(Stepping(step, *AVERAGE, gg=gg)), settings, Stepping(step, *AVERAGE, gg=gg), target


def _at_its_step(unit: Stepping, settings: dict[str, Any], target: float, omega: float) -> Candidate:
    """Return a scheme at the smallest step at which it has the target."""
    ratios = _ratios(unit)
    reached = np.flatnonzero(ratios >= target)
    if not reached.size:
        return _named(unit), settings, None, float(np.nanmax(ratios))
    i = int(reached[0])
    W = _root(unit.damping_ratio, target, float(OMEGAS[max(i - 1, 0)]), float(OMEGAS[i]))
    step = (float(OMEGAS[i]) if W is None else W) / omega
    stepping = unit.at(step)
    return _named(unit), settings | {"time.step": step, "time.gg": 1.0}, stepping, target


@functools.lru_cache(maxsize=64)
def _ratios(unit: Stepping) -> Any:
    """Return xi over `OMEGAS`, of which not a number is never reached."""
    return np.array([unit.damping_ratio(float(W)) for W in OMEGAS])


def _at_the_present_step(step: float, target: float, omega: float) -> Iterator[Candidate]:
    """Yield the schemes of one parameter with the value of it that has the target at a step."""
    W = omega * step

    def family(delta: float) -> Stepping:
        return Stepping(step, (0.5 + delta) ** 2 / 4, delta)

    delta = _root(lambda value: family(value).damping_ratio(W), target, 0.5, 1.5)
    if delta is not None:
        stepping = family(delta)
        settings: dict[str, Any] = {
            "time.alpha": stepping.alpha,
            "time.delta": delta,
            "time.step": step,
            "time.gg": 1.0,
        }
        yield _named(stepping), settings, stepping, target
    for scheme, radii in LADDER.items():
        least = 0.5 if scheme == "hht" else 0.0

        def ratio(radius: float, scheme: str = scheme) -> float:
            return Stepping.named(scheme, step, rho_inf=radius).damping_ratio(W)

        radius = _root(ratio, target, least, 1.0)
        if radius is not None and all(abs(radius - value) > 1e-6 for value in radii):
            stepping = Stepping.named(scheme, step, rho_inf=radius)
            settings = {"time.scheme": scheme, "time.rho_inf": radius, "time.step": step, "time.gg": 1.0}
            yield _named(stepping), settings, stepping, target


def _root(ratio: Callable[[float], float], target: float, low: float, high: float) -> float | None:
    """Return where a function has the target between two ends; None where they do not bracket it."""
    from scipy.optimize import brentq

    ends = [ratio(end) - target for end in (low, high)]
    if not all(map(math.isfinite, ends)) or ends[0] * ends[1] > 0:
        return None
    return float(brentq(lambda value: ratio(value) - target, low, high, xtol=1e-15, rtol=1e-14))


def _named(stepping: Stepping) -> str:
    """Name a scheme with its numbers."""
    if stepping.scheme == "newmark":
        name = f"Newmark ({stepping.alpha:.6g}, {stepping.delta:.6g})"
    else:
        name = f"{stepping.scheme} (rho_inf = {stepping.rho_inf:.6g})"
    return name if stepping.gg == 1 else f"{name} with gg = {stepping.gg:.6g}"


# ---- one offer ------------------------------------------------------------------------------------------------------


def _offer(
    scene: Scene,
    omega: float,
    frequencies: BlockFrequencies,
    name: str,
    settings: dict[str, Any],
    stepping: Stepping,
) -> Offer:
    """Return a scheme at its step with all that follows from it."""
    dt = stepping.step
    contact = frequencies.highest * dt
    impact = frequencies.impact * dt
    statistics = _rebound(stepping.stages, min(max(impact, LEAST_IMPACT), IMPACTS[-1]))
    greatest = max(_rebound(stepping.stages, W).most for W in IMPACTS)
    present = Stepping.of(scene)
    cost = stepping.solves / dt / (present.solves / present.step) if present.solves else None
    radius = stepping.spectral_radius(contact)
    offer = Offer(
        name=name,
        settings=settings,
        step=dt,
        gg=stepping.gg,
        damping=stepping.damping_ratio(omega * dt),
        period_error=stepping.period_error(omega * dt),
        hidden={f"{share * omega / (2 * math.pi):.6g}": _number(stepping, share * omega * dt) for share in OTHERS},
        first_mode=_number(stepping, frequencies.first * dt),
        contact_mode=_number(stepping, contact),
        contact_radius=radius,
        cost=cost,
        rebound={"mean": statistics.mean, "least": statistics.least, "most": statistics.most},
        greatest_rebound=greatest,
        gains=statistics.most > 1 + GAIN,
        start_rise=overshoot.rise_of(stepping, frequencies.modes),
        fears=(),
    )
    return replace(offer, fears=tuple(_fears(offer, omega)))


def _number(stepping: Stepping, omega_dt: float) -> float | None:
    xi = stepping.damping_ratio(omega_dt)
    return xi if math.isfinite(xi) else None


@functools.lru_cache(maxsize=4096)
def _rebound(stages: Stages, omega: float) -> ReboundStatistics:
    """Return the rebound of a rigid mass at W = w_c dt, to which a discount adds nothing."""
    return rebound_statistics(spring_steps(stages, omega))


def _fears(offer: Offer, omega: float) -> Iterator[str]:
    """Yield what is to be feared of an offer."""
    if offer.gains:
        yield f"an impact at this step gives back up to {offer.rebound['most']:.3g} times its speed"
    elif offer.greatest_rebound > 1 + GAIN:
        yield f"at longer steps or stiffer contact impacts give back up to {offer.greatest_rebound:.3g} times the speed"
    if offer.start_rise is not None and offer.start_rise > overshoot.NOTABLE:
        rise = percent(offer.start_rise)
        yield f"from a consistent start under a load at once the first step adds {rise} of the energy it gives"
    if offer.contact_radius > KEEPS:
        yield f"the contact mode keeps {100 * offer.contact_radius:.3g} % of its amplitude a step"
    if offer.gg < 1:
        drag = -math.log(offer.gg) / offer.step
        yield f"the discount is a drag of {drag:.3g} 1/s in flight and in sliding, and damps slow motion most"
    if offer.first_mode is None:
        yield "the block's first axial mode no longer oscillates"
    elif offer.first_mode > 2 * offer.damping:
        yield f"the block's first axial mode is damped at {percent(offer.first_mode)}"
    if abs(offer.period_error) > 0.02:
        size = "long" if offer.period_error > 0 else "short"
        yield f"the period at the requested frequency is {percent(abs(offer.period_error))} too {size}"
    steps = 2 * math.pi / (omega * offer.step)
    if steps < STEPS:
        yield f"only {steps:.2g} steps a period of the requested frequency"


def _sentence(advice: SchemeAdvice) -> str:
    """Return the answer in one sentence."""
    wish = f"{percent(advice.target)} at {advice.frequency:.4g} Hz"
    if advice.no_gain:
        wish += " and nothing gained on contact"
    fitting = [offer for offer in advice.offers if not (advice.no_gain and offer.gains)]
    if not fitting:
        nothing = "no scheme has it" if not advice.offers else "every scheme that has the damping gains on contact"
        return f"{wish}: {nothing}; take another damping ratio, or a smaller step with a contact dashpot."
    answers = [f"{offer.name} at dt = {offer.step:.4g} s" for offer in fitting[:2]]
    return f"{wish}: {', or '.join(answers)}."
