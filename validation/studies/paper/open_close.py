"""The claims C14 to C16 of the register: what the paper says of open-close, on one block and on twenty rigid ones.

One matrix belongs to all schemes at a step, so that delta alone differs.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

from validation.scenes.scene import Scene
from validation.studies.paper.slips import CORNER_M, CORNER_N, SHEAR_M, SHEAR_N, model
from validation.suite.claims import Evidence, Tests, named, whole

CASES = named("open-close")
DAMPED, UNDAMPED = ([name for name, s in CASES.items() if s.time.delta == delta] for delta in (1, 0.5))
# Of the cases of a scheme, by time step
COARSE = 0
FINE = -1
REST, SHAKEN = (named(f"columns-solves-{stack}") for stack in ("rest", "shaken"))


def stacks(cases: dict[str, Scene], delta: float) -> list[str]:
    """Return the cases of twenty blocks under a scheme, longest step first."""
    chosen = [name for name, scene in cases.items() if scene.time.delta == delta]
    return sorted(chosen, key=lambda name: -cases[name].time.step)


STATES = 4000  # random states of two corners
MOST_SOLVES = 6  # of a step in DDA, before it is cut
LOOSE = stacks(REST, 0.5)  # twenty blocks that nothing damps
DAMPED_STACKS = stacks(REST, 1.0)


def most_solves(e: Evidence, cases: list[str]) -> float:
    """Return the most solves in a step of any case."""
    return whole(max(e.number(case, "contact.most_solves") for case in cases))


class BondedCorners(NamedTuple):
    """How many random states of two corners, bonded in shear while closed, have no answer, or several."""

    unsolvable: int  # no combination of open and closed corners fits
    ambiguous: int  # several combinations fit
    unconverged: int  # the iteration from both corners closed does not end in the solves that DDA allows


def bonded_corners(case: str, alpha: float, step: float) -> BondedCorners:
    """Count the random states of the paper's block on two corners that stick while they are closed.

    With the forces lambda = -p w of the closed corners, normal and tangential, the gaps at the end of a step are

        w = w_f + C lambda,        C = alpha dt^2 B S^-1 B',        S = M + alpha dt^2 K,

    where w_f are those without contact forces: all that the scheme's delta and gg act on, here drawn from a normal
    distribution in all four directions, whose scale does not matter. A combination of open and closed corners fits
    where the closed ones press, w < 0, and the open ones do not.
    """
    block_model = model(case)
    system = block_model.mass + alpha * step**2 * block_model.block.elastic()
    corners = np.array([CORNER_M, CORNER_N, SHEAR_M, SHEAR_N])
    flexibility = alpha * step**2 * corners @ np.linalg.solve(system, corners.T)
    free_gaps = np.random.default_rng(0).standard_normal((STATES, 4))
    closes = {}
    for closed in itertools.product((False, True), repeat=2):
        active = np.flatnonzero(closed + closed)  # normal and tangential springs of the closed corners
        springs = block_model.contact.stiffness * np.eye(len(active))
        coupled = np.eye(len(active)) + flexibility[np.ix_(active, active)] @ springs
        forces = -np.linalg.solve(coupled.T, springs).T @ free_gaps[:, active].T
        closes[closed] = (free_gaps[:, :2] + (flexibility[:2, active] @ forces).T) < 0
    fitting = sum((next_state == state).all(axis=1).astype(int) for state, next_state in closes.items())
    state = np.ones((STATES, 2), bool)
    converged = np.zeros(STATES, bool)
    for _ in range(MOST_SOLVES):
        following = np.array([closes[m, n][row] for row, (m, n) in enumerate(state.tolist())])
        converged |= (following == state).all(axis=1)
        state = following
    return BondedCorners(int((fitting == 0).sum()), int((fitting > 1).sum()), int((~converged).sum()))


def guaranteed(e: Evidence) -> dict[str, float]:
    """Return the most solves with and without algorithmic damping, the cuts without, and the counterexample."""
    case = DAMPED[COARSE]
    by_step = {step: bonded_corners(case, 0.5, step) for step in (1e-2, 2e-3, 1e-3, 1e-4)}
    coarse = by_step[1e-2]
    with_damping = most_solves(e, DAMPED)
    without = most_solves(e, UNDAMPED)
    return {
        "most solves a step with damping, (1/2, 1)": with_damping,
        "most solves a step without, (1/4, 1/2)": without,
        "solves that damping spares": without - with_damping,
        "cut steps without": whole(sum(e.number(case, "contact.cuts") for case in UNDAMPED)),
        "most solves of twenty blocks with damping": most_solves(e, DAMPED_STACKS),
        "of twenty blocks without, where 21 are possible": most_solves(e, LOOSE),
        f"of {STATES} random states of two corners bonded in shear, dt = 10 ms: none fits": coarse.unsolvable,
        "several fit": coarse.ambiguous,
        "do not converge in six solves": coarse.unconverged,
        "at 2 ms": by_step[2e-3].unconverged,
        "at 1 ms": by_step[1e-3].unconverged,
        "at 0.1 ms": by_step[1e-4].unconverged,
        "undamped with the same alpha dt^2": bonded_corners(case, 0.25, np.sqrt(2) * 1e-2).unconverged,
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
    """Return the mean solves a step by case."""
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


TESTS: Tests = {
    "C14": ((*DAMPED, *UNDAMPED, *LOOSE, *DAMPED_STACKS), guaranteed),
    "C15": ((*UNDAMPED, *LOOSE), vibrating),
    "C16": ((*DAMPED, *LOOSE, *DAMPED_STACKS, *stacks(SHAKEN, 1.0)), essence),
}
