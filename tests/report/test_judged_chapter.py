"""The page of a judged answer: error and allowed in per cent, numbers beside, curves of the answer and of the truth."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from oracles.made_cases import made_history

from validation.gates.gate import Status
from validation.problems.answers import Answer, AnswerSet, stated_by
from validation.problems.bands import Standard
from validation.problems.cause import Cause
from validation.problems.judge import Criterion, Judgement
from validation.problems.problem import problem
from validation.problems.quantities import Quantity
from validation.report.blocks import Paragraph
from validation.report.chapters import answers
from validation.report.chapters import judged as chapter
from validation.runs.history import History
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
    return JudgedAnswer(
        name="locked", problem=one, history=ANSWER, standard=Standard(EXACT, {}, {}), judgement=found, cause=Cause()
    )


def test_the_page_has_errors_numbers_and_curves(kept, kept_figures, drawn, tmp_path):
    kept("judged", chapter.page(judged(), tmp_path))
    kept_figures("figures-judged", drawn)


def test_an_answer_that_is_exact_lies_on_the_exact_motion(kept, drawn, tmp_path):
    kept("judged-exact", chapter.figures(replace(judged(), history=EXACT), tmp_path))


def boxes():
    """Return an answer to a problem that is judged by numbers, of which one cannot be measured."""
    one = problem("impact")
    criteria = (
        Criterion("rebound", Status.FAIL, 0.5, 0.01, 0.3, "of the speed", 0.0),
        Criterion("sinking", Status.PASS, 0.0, 0.0, 0.3, "of the side", 0.3),
    )
    numbers = (
        Quantity("rebound", "m/s", 0.7071, 1.4, (1.386, 1.414)),
        Quantity("sinking", "1", None, 0.0, (0.0, 0.01)),
    )
    time = 0.1 * np.arange(1, 4)
    history = History(time, {name: 0.0 * time if name == "box.angle" else time for name in one.columns})
    return JudgedAnswer(
        name="impact", problem=one, history=history, standard=None,
        judgement=Judgement("impact", criteria, numbers), cause=None,
    )  # fmt: skip


def partial():
    """Return an answer that withholds a column, whose scheme would pass at a seventh of the step."""
    one = judged()
    asked = replace(one.judgement.criteria[0], status=Status.NOT_REPORTED, error=None)
    criteria = (replace(asked, reason="it is asked for"), *one.judgement.criteria[1:])
    why = Cause("a scheme.", ("scheme",), {"gg": 0.5}, passing_step=one.problem.scene.time.step / 7)
    judgement = replace(one.judgement, criteria=criteria, quantities=())
    return replace(one, judgement=judgement, cause=why, warnings=("It does not repeat.",))


def test_what_a_verdict_rests_on_is_said(kept, kept_figures, drawn, tmp_path):
    """Of a part that is withheld, a scheme that passes at a finer step, numbers of boxes, two causes that are alike."""
    alike = replace(judged(), cause=Cause(alike=("a", "b")))
    first_step = replace(judged().judgement.criteria[0], within=0.0)
    early = replace(alike, judgement=Judgement("locked", (first_step,)))
    unjudged = replace(early, judgement=Judgement("locked", judged().judgement.criteria[2:]))
    blocks = [block for one in (partial(), boxes()) for block in chapter.verdict_blocks(one)]
    blocks += [*chapter.verdict_blocks(early, "Mine: ")[:3], Paragraph(chapter.headline(unjudged))]
    for quantity in (None, boxes().judgement.quantities[0]):
        judgement = boxes().judgement
        numbers = (quantity or replace(judgement.quantities[0], value=None), judgement.quantities[1])
        blocks.append(Paragraph(chapter.headline(replace(boxes(), judgement=replace(judgement, quantities=numbers)))))
    kept("judged-otherwise", [*blocks, *chapter.figures(boxes(), tmp_path)])
    kept_figures("figures-boxes", drawn)
    assert chapter.as_data(partial()) == {
        "verdict": "PARTIAL",
        "not_reported": ["displacement_m"],
        "cause": {"sentence": "a scheme.", "ids": ["scheme"], "values": {"gg": 0.5}, "passing_step_s": 0.002 / 7},
        "criteria": [
            {"name": name, "verdict": str(status), "error": error, "allowed": allowed, "until_s": until,
             "within_until_s": within, "reason": reason}
            for name, status, error, allowed, until, within, reason in (
                ("displacement_m", Status.NOT_REPORTED, None, 0.05, 0.3, 0.1, "it is asked for"),
                ("contact_pressure_Pa", Status.PASS, 0.0125, 0.025, 0.2, 0.2, ""),
                ("rotation_rad", Status.NOT_JUDGED, None, None, 0.3, 0.0, "it is zero throughout"),
            )
        ],
        "numbers": [],
        "warnings": ["It does not repeat."],
    }  # fmt: skip
    data = chapter.as_data(replace(early, judgement=boxes().judgement))
    assert data["numbers"][0] == {
        "name": "rebound",
        "unit": "m/s",
        "value": 0.707,
        "exact": 1.4,
        "low": 1.39,
        "high": 1.41,
    }
    assert (data["cause"]["would_tell"], data["cause"]["ids"]) == (alike.cause.would_tell, [])
    assert [chapter.rounded(x) for x in (0.0, -1e-15, 1234.5, None)] == [0.0, -1e-11, 1230.0, None]


def test_the_first_page_has_problems_against_programs_and_names_those_without_an_answer(kept):
    mine = stated_by("Mine", version="1.0", settings_name="fine", step_s={"locked": 0.002}, who="me", licence="CC0")
    away = Answer("locked", problem("locked"), None, Status.NOT_RUN, "it is away")
    old = Answer("gone", None, None, Status.FAIL, "stale")
    sets = [
        AnswerSet(Path("mine"), mine, (replace(partial(), seconds=1.234), boxes(), old)),
        AnswerSet(Path("away"), stated_by("Away"), (away,)),
        AnswerSet(Path("no"), stated_by("Other", who="you"), (replace(old, name="locked"),)),
    ]
    kept("answers", answers.first_page(sets))
    assert [answers.headline(one) for one in sets] == ["0 of 3 PASS, 2 FAIL, 1 PARTIAL", "0 of 1 PASS, 1 NOT RUN",
                                                       "0 of 1 PASS, 1 FAIL"]  # fmt: skip
    assert answers.with_answers(sets[1:2]) == sets[1:2]
