"""The claims C14 to C18 of the register: what the paper says of open-close, on one block and on twenty.

The twenty are rigid ones on each other. One matrix belongs to all schemes at a step, so that delta alone differs.
"""

from __future__ import annotations

from validation.scenes.scene import Scene
from validation.solvers.rigid.impacts import impact_statistics
from validation.suite.claims import Evidence, Tests, named, whole
from validation.theory import landing

CASES = named("open-close")
DAMPED, UNDAMPED = (
    [name for name, s in CASES.items() if s.time.delta == delta and s.time.gg == 1] for delta in (1, 0.5)
)
DISCOUNTED = [name for name, s in CASES.items() if s.time.discount < 1]
# Of the cases of a scheme, by time step
COARSE = 0
FINE = -1
REST, SHAKEN = (named(f"columns-solves-{stack}") for stack in ("rest", "shaken"))


def stacks(cases: dict[str, Scene], delta: float) -> list[str]:
    """Return the cases of twenty blocks under a scheme, the longest step first."""
    chosen = [name for name, scene in cases.items() if scene.time.delta == delta]
    return sorted(chosen, key=lambda name: -cases[name].time.step)


LOOSE = stacks(REST, 0.5)  # twenty blocks that nothing damps
DAMPED_STACKS = stacks(REST, 1.0)


def omega(scene: Scene) -> float:
    """Return w_c dt with w_c = sqrt(8 p / m): of a quarter of the mass, as p = 100 E is much stiffer than the block."""
    return landing.quarter_mass_frequency(scene) * scene.time.step


def most_solves(e: Evidence, cases: list[str]) -> float:
    """Return the largest number of solves in a step of any case."""
    return whole(max(e.number(case, "contact.most_solves") for case in cases))


def guaranteed(e: Evidence) -> dict[str, float]:
    """Return the most solves with and without algorithmic damping, and the cuts without."""
    with_damping = most_solves(e, DAMPED)
    without = most_solves(e, UNDAMPED)
    return {
        "most solves a step with damping, (1/2, 1)": with_damping,
        "most solves a step without, (1/4, 1/2)": without,
        "solves that damping spares": without - with_damping,
        "cut steps without": whole(sum(e.number(case, "contact.cuts") for case in UNDAMPED)),
        "most solves of twenty blocks with damping": most_solves(e, DAMPED_STACKS),
        "of twenty blocks without, where 21 are possible": most_solves(e, LOOSE),
    }


def vibrating(e: Evidence) -> dict[str, float]:
    """Return switches at the smallest step, and how the solves change towards it."""
    solves = [e.number(case, "contact.mean_solves") for case in UNDAMPED]
    of_twenty = mean_solves(e, LOOSE)
    return {
        "openings and closings at dt = 1e-4 s": whole(e.number(UNDAMPED[FINE], "switches.count")),
        "mean solves a step at dt = 1e-3 s": solves[COARSE],
        "at dt = 1e-4 s": solves[FINE],
        "rise of the mean solves": solves[FINE] - solves[COARSE],
        "mean solves of twenty blocks at w dt = 10": of_twenty[COARSE],
        "of twenty blocks at w dt = 0.1": of_twenty[FINE],
        "their rise": of_twenty[FINE] - of_twenty[COARSE],
    }


def mean_solves(e: Evidence, cases: list[str]) -> list[float]:
    """Return the mean solves a step of each case."""
    return [e.number(case, "contact.mean_solves") for case in cases]


def essence(e: Evidence) -> dict[str, float]:
    """Return how the most solves and the switches under (1/2, 1) change with the step."""
    most = [most_solves(e, [case]) for case in DAMPED]
    switches = [whole(e.number(case, "switches.count")) for case in DAMPED]
    loose, at_rest = mean_solves(e, LOOSE), mean_solves(e, DAMPED_STACKS)
    shaken = mean_solves(e, stacks(SHAKEN, 1.0))
    return {
        "change of the most solves over dt": max(most) - min(most),
        "switches at dt = 1e-3 s": switches[COARSE],
        "at dt = 1e-4 s": switches[FINE],
        "rise of the switches": switches[FINE] - switches[COARSE],
        "change of the mean solves of twenty blocks with the step, undamped": loose[COARSE] - loose[FINE],
        "the same under (1/2, 1), where they come to rest": at_rest[COARSE] - at_rest[FINE],
        "the same where the base shakes on": shaken[COARSE] - shaken[FINE],
        "solves that damping saves twenty blocks in the mean at w dt = 2": loose[1] - at_rest[1],
    }


def right_scheme(e: Evidence) -> dict[str, float]:
    """Return the energy that constant acceleration gains, and the range of a contact's restitution at dt = 1e-3 s."""
    coarse = CASES[DAMPED[COARSE]]
    _, low, high, _ = impact_statistics(coarse.time.alpha, coarse.time.delta, coarse.time.discount, omega(coarse))
    return {
        "energy gained, over that given": max(e.number(case, "energy.rise") for case in DAMPED),
        "w_c dt at dt = 1e-3 s": omega(coarse),
        "least restitution there": low,
        "greatest there": high,
        "range of the restitution": high - low,
    }


def discounted(e: Evidence) -> dict[str, float]:
    """Return the energy that average acceleration gains at gg = 0.95."""
    gains = [e.number(case, "energy.rise") for case in DISCOUNTED]
    return {
        "energy gained at gg = 0.95 and dt = 1e-3 s, over that given": gains[COARSE],
        "at dt = 2e-4 s": gains[FINE],
        "w_c dt at dt = 1e-3 s": omega(CASES[DISCOUNTED[COARSE]]),
    }


TESTS: Tests = {
    "C14": ((*DAMPED, *UNDAMPED, *LOOSE, *DAMPED_STACKS), guaranteed),
    "C15": ((*UNDAMPED, *LOOSE), vibrating),
    "C16": ((*DAMPED, *LOOSE, *DAMPED_STACKS, *stacks(SHAKEN, 1.0)), essence),
    "C17": (DAMPED, right_scheme),
    "C18": (DISCOUNTED, discounted),
}
