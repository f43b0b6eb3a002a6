"""Answers of other programs that are kept: their verdicts are those that the page of what is verified states."""

import pytest
from conftest import script

from validation.problems.problem import names
from validation.suite import judging
from validation.suite.matrix import phenomena, phenomenon


@pytest.fixture
def verification(monkeypatch):
    monkeypatch.setattr(judging, "cause", lambda *failed: None)  # which is searched by runs of other scenes
    return script("verification", monkeypatch)


def stated(verification, shown):
    """Return what other programs pass of a phenomenon, judged anew and as the page states it."""
    fresh = verification.by_others(shown, verification.judged_answers(list(filter(shown.asked_by, names()))))
    return {program: list(tally) for program, tally in fresh.items()}, verification.read()[shown.name].others


@pytest.mark.parametrize("name", ["push each", "impact on a corner"])
def test_the_page_states_what_is_judged(name, verification):
    fresh, others = stated(verification, phenomenon(name))
    assert fresh == others


@pytest.mark.long
def test_the_page_states_what_is_judged_of_all(verification):
    for shown in phenomena():
        if shown.problems:
            fresh, others = stated(verification, shown)
            assert fresh == others, shown.name


def test_every_problem_of_the_pack_asks_for_one_phenomenon():
    for name in names():
        assert len([shown for shown in phenomena() if shown.asked_by(name)]) == 1, name
