"""The study `rebound`: the gates of its map are bitten, its closed forms and scenes are what they say."""

import math

import pytest

from validation.studies.rebound import formulas as rebound
from validation.suite.folders import get_study
from validation.suite.own_solver.gates import applies


def test_the_closed_forms_of_a_rigid_contact():
    """(1/2, 1) returns |2 theta - 1|; (1/4, 1/2) 3 - 8 theta up to 1/3, then 4 theta - 1."""
    for theta in (0.05, 0.25, 0.4, 0.77):
        assert rebound.impact_restitution(0.5, 1.0, 1.0, math.inf, theta) == pytest.approx(abs(2 * theta - 1))
        average = 3 - 8 * theta if theta < 1 / 3 else 4 * theta - 1
        assert rebound.impact_restitution(0.25, 0.5, 1.0, math.inf, theta) == pytest.approx(average)


def test_a_users_solver_is_not_asked_for_contact_that_opens():
    opening = [gate for gate in get_study("rebound").gates() if gate.pair == ("dda",)]
    assert opening and not any(applies("rebound", gate) for gate in opening)
