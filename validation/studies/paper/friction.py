"""The claims C20 to C22 of the register: what is said of blocks on inclines."""

from __future__ import annotations

from validation.studies.paper.claims import Band, Claim, Evidence, Finding, by_dda, named
from validation.theory import friction

CREEP = named("creep-claim")
SLIDES = named("slope-sliding")
LAGGED, CONSISTENT = ([name for name, s in CREEP.items() if s.contact.rules == r] for r in ("lagged", "consistent"))
RULES = {"lagged": LAGGED, "consistent": CONSISTENT}
# Of the cases of a rule, by time step
COARSE = 0
FINE = -1
STANDS = 1e-9  # m/s, rounding
PLACE = "not in the paper: said where block codes are checked on inclines"


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


ON_SLOPES = (
    Claim(
        "C20",
        PLACE,
        "A block below its angle of friction stands.",
        by_dda((*LAGGED, *CONSISTENT)),
        standing,
        tuple(Band(f"greatest slip a second at the end, {rule}, m/s", 0, STANDS) for rule in RULES),
        Finding.CONDITIONAL,
        "constant acceleration damps the ringing that lets it slip, and it comes to rest; where friction is that of "
        "the pass before it creeps, and the exact block, whose ringing nothing damps, creeps as well",
        "where stick and slip are states of the iteration, under constant acceleration",
        (Band("greatest slip a second at the end, consistent, m/s", 0, STANDS),),
    ),
    Claim(
        "C21",
        PLACE,
        "Penalty springs put a systematic error into the run-out of a sliding block.",
        by_dda(SLIDES),
        beyond,
        tuple(Band(f"over tan(phi) x settlement at dt = {s.time.step:g}", 0.999, 1.001) for s in SLIDES.values()),
        Finding.CONFIRMED,
        "it is tan(phi) times the settlement on the springs, whatever time step and distance",
    ),
    Claim(
        "C22",
        PLACE,
        "A block below its angle of friction stands the better the finer the time step.",
        by_dda((*LAGGED, *CONSISTENT)),
        refined,
        tuple(Band(f"slip at the finest step over that at the coarsest, {rule}", 0, 1) for rule in RULES),
        Finding.REFUTED,
        "by either rule it slides the farther the finer the step, by consistent ones about as 1/dt: what stops it is "
        "the damping of its ringing by the step",
    ),
)
