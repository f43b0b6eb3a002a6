"""What commands print and how they end, from answers, rows and runs made by hand: each word with its own number."""

from pathlib import Path

import numpy as np
import pytest
import typer

from validation import load_scene, response
from validation.cli import judge as cli_judge
from validation.cli import waves as cli_waves
from validation.gates.gate import Status
from validation.problems.answers import Answer, AnswerSet, stated_by
from validation.report.figures import response as figures
from validation.runs.run import Outcome, Run
from validation.suite import judging

SCENE = load_scene("figures-3-4").with_values({"time.step": 0.002})
# ---- statuses -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("outcome", [Outcome.TIMEOUT, Outcome.RAISED, Outcome.OVERFLOW, Outcome.COMPLETED])
def test_a_solver_that_gives_no_answer_is_a_numerical_failure(outcome, capsys):
    status, reason = judging._ending(Run(outcome, notes=("whatever",)))
    answers = AnswerSet(Path("mine"), stated_by("mine"), (Answer("locked", None, None, status, reason),))
    with pytest.raises(typer.Exit) as ended:
        cli_judge._refuse_inapplicable(answers)
    assert ended.value.exit_code == 3
    said = capsys.readouterr().out
    assert said.startswith(f"locked mine: {status}: ") and "whatever" in said
    assert status is (Status.FAIL if outcome is Outcome.OVERFLOW else Status.NOT_RUN)


# ---- figures of frequencies ---------------------------------------------------------------------------------------


def test_what_is_stepped_is_drawn_up_to_half_the_sampling_and_the_exact_answer_to_the_end(monkeypatch, tmp_path):
    caught = []
    monkeypatch.setattr(figures, "response_figure", lambda curves, *rest: caught.extend(curves))
    monkeypatch.setattr(figures, "save_as", lambda figure, path: path)
    frequency = np.array([100.0, 249.0, 251.0, 900.0])
    answers = {"dda": response(SCENE, frequency, "dda"), cli_waves.EXACT: response(SCENE, frequency, "dda", True)}
    cli_waves._draw(SCENE, answers, False, tmp_path / "r.svg")
    seen = {curve.name: np.isfinite(curve.columns["displacement"][0]).tolist() for curve in caught}
    stepped, *others = caught
    assert stepped.name.startswith("dda ") and seen.pop(stepped.name) == [True, True, False, False]
    assert [*seen.values()] == [[True] * 4] * len(others)
    assert [curve.dashed for curve in caught] == [False, True, False]
