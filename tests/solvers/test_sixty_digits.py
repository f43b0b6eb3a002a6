"""The sixty-digit block against another route to the same numbers."""

import pytest
from conftest import thinned
from flint import ctx
from mpmath import mp, mpf
from oracles import block_in_digits

from validation.solvers.registry import get_solver
from validation.solvers.sixty_digits import block as precise_block

COLUMNS = ("displacement", "contact_pressure")
OBLONG = {"block.width": 1.3, "block.height": 2.9, "contact.shear_stiffness": 3e8}


def exactly(values):
    """Midpoints of balls; call it with enough digits set."""
    return [mpf(value.str(mp.dps, radius=False)) for value in values]


SCHEMES = [(0.5, 1.0, 1.0, "zero"), (0.3025, 0.6, 0.9, "consistent"), (0.0, 0.5, 1.0, "zero")]


@pytest.mark.parametrize(
    ("outline", "alpha", "delta", "gg", "start"),
    thinned(((outline, *scheme) for outline in ("square", "oblong") for scheme in SCHEMES), 2),
)
def test_the_block_by_trace_and_determinant_is_the_block_by_steps(scene, outline, alpha, delta, gg, start):
    values = {"time.alpha": alpha, "time.delta": delta, "time.gg": gg, "time.start": start, "block.poisson": 0.31}
    if outline == "oblong":
        values |= OBLONG
    case = scene.with_values(values)
    block = get_solver("dda").prepare(case)
    reference = block_in_digits.locked_history(block.model, block.scheme, case.time.steps)
    found = precise_block.history(case, COLUMNS)
    assert ctx.prec == 53
    for name, exact in zip(COLUMNS, reference, strict=True):
        with mp.workdps(80):
            peak = max(abs(x) for x in exact)
            assert max(abs(a - b) for a, b in zip(exactly(found[name]), exact, strict=True)) < mpf(10) ** -60 * peak
