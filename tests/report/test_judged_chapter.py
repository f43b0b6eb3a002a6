"""The page of a judged answer: error and allowed in per cent, numbers beside, curves of the answer and of the truth."""

from dataclasses import replace

from oracles.made_cases import made_history

from validation.gates.gate import Status
from validation.problems.answers import Answer
from validation.problems.bands import Standard
from validation.problems.cause import Cause
from validation.problems.judge import Criterion, Judgement
from validation.problems.problem import problem
from validation.problems.quantities import Quantity
from validation.report.chapters import judged as chapter
from validation.suite.judging import JudgedAnswer

EXACT = made_history(0.1, [-1e-3, -2e-3, -3e-3], [1e6, 2e6, 3e6])
ANSWER = made_history(0.1, [-1e-3, -1e-3, -2e-3, 9.0], [1e6, 1e6, 1e6, 9.0])  # one row longer


def judged():
    criteria = (
        Criterion("displacement", Status.FAIL, 0.125, 0.05, 0.3, "", 0.1, "block.young"),
        Criterion("contact_pressure", Status.PASS, 0.0125, 0.025, 0.2, "", 0.2, "load.pressure"),
        Criterion("rotation", Status.NOT_JUDGED, None, None, 0.3, "it is zero throughout"),
    )
    found = Judgement("locked", criteria, (Quantity("first peak", "mm", 2.0, 3.0),))
    one = problem("locked")
    return JudgedAnswer(Answer("locked", one, ANSWER), one, ANSWER, Standard(EXACT, {}, {}), found, Cause())


def test_the_page_has_errors_numbers_and_curves(kept, kept_figures, drawn, tmp_path):
    kept("judged", chapter.page(judged(), tmp_path))
    kept_figures("figures-judged", drawn)


def test_an_answer_that_is_exact_lies_on_the_exact_motion(kept, drawn, tmp_path):
    kept("judged-exact", chapter.figures(replace(judged(), history=EXACT), tmp_path))
