"""The claims C20 to C22 of the register: what is said of blocks on inclines."""

from __future__ import annotations

from validation.suite.claims import Evidence, Tests, named
from validation.theory import friction

CREEP = named("creep-claim")
SLIDES = named("slope-sliding")
LAGGED, CONSISTENT = ([name for name, s in CREEP.items() if s.contact.rules == r] for r in ("lagged", "consistent"))
RULES = {"lagged": LAGGED, "consistent": CONSISTENT}
# Of the cases of a rule, by time step
COARSE = 0
FINE = -1


def standing(e: Evidence) -> dict[str, float]:
    """Return the slip a second that goes on at the end, by rule."""
    return {
        f"greatest slip a second at the end, {rule}, m/s": max(e.number(name, "contact.slip_rate") for name in names)
        for rule, names in RULES.items()
    }


def refined(e: Evidence) -> dict[str, float]:
    """Return the slip over the step by both rules, and how it grows from the coarsest step to the finest."""
    slip_by_step = {}
    growth = {}
    for rule, names in RULES.items():
        slips = [e.number(name, "contact.slip") for name in names]
        for name, slip in zip(names, slips, strict=True):
            slip_by_step[f"slip at dt = {CREEP[name].time.step:g}, {rule}, mm"] = 1e3 * slip
        growth[f"slip at the finest step over that at the coarsest, {rule}"] = slips[FINE] / slips[COARSE]
    return slip_by_step | growth


def beyond(e: Evidence) -> dict[str, float]:
    """Return how far sliding blocks are beyond the closed form, over tan(phi) times the settlement."""
    offsets = {}
    for name, scene in SLIDES.items():
        free, _ = friction.free_motion(scene, friction.sliding_acceleration(scene))
        offset = e.number(name, "horizontal.final") - float(free[-1])
        offsets[f"over tan(phi) x settlement at dt = {scene.time.step:g}"] = offset / friction.penalty_offset(scene)
    offsets["tan(phi) x settlement, mm"] = 1e3 * friction.penalty_offset(next(iter(SLIDES.values())))
    return offsets


TESTS: Tests = {
    "C20": ((*LAGGED, *CONSISTENT), standing),
    "C21": (SLIDES, beyond),
    "C22": ((*LAGGED, *CONSISTENT), refined),
}
