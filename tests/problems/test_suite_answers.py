"""What this suite's own solvers answer: at fine steps DDA passes, by its habit it damps; the page has the bands."""

import pytest

from validation.diagnosis.hooks import DiagnosisHooks
from validation.gates.gate import Status
from validation.problems.judge import judge
from validation.problems.problem import problem
from validation.runs.history import History
from validation.scenes import features
from validation.solvers.registry import get_solver

FINER, FINER_TURNING = 32, 4  # steps in one of the scene's; of a block that turns, which takes long
SLOW = [pytest.param(name, marks=pytest.mark.long) for name in ("opening", "sliding", "rocking", "column")]


@pytest.mark.parametrize("name", ["locked", *SLOW])
def test_at_fine_steps_dda_passes(name):
    """Its error is that of its scheme, far below what one per cent of the data changes."""
    one = problem(name)
    scene = one.scene
    every = FINER_TURNING if features.ROTATION in features.of(scene) else FINER
    steps = {"time.step": scene.time.step / every, "time.steps": scene.time.steps * every}
    history = get_solver("dda").solve(scene.with_values(DiagnosisHooks.of(scene).accurate(scene) | steps)).history
    rows = slice(every - 1, None, every)
    sampled = History(history.time[rows], {column: x[rows] for column, x in history.columns.items()})
    assert judge(one, sampled).status is Status.PASS
