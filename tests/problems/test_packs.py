"""Versions of the pack: digests of problems, and which answers to an earlier pack are answers to this one."""

import itertools
import json
from dataclasses import replace

import pytest

from validation.problems import packs
from validation.problems.data import PACK
from validation.problems.packs import digest, stale
from validation.problems.problem import names, problem


def test_the_version_of_the_pack_is_that_of_its_problems():
    digests = {name: digest(problem(name)) for name in names()}
    assert packs.packs().get(PACK) == digests, (
        "problems are others: give the pack another version (PACK; minor where problems are added only), "
        f"and packs.json these digests of it: {json.dumps(digests)}"
    )


def test_a_minor_version_adds_problems_only():
    versions = sorted(packs.packs(), key=lambda version: [int(part) for part in version.split(".")])
    assert versions == list(packs.packs()) and versions[-1] == PACK
    for before, after in itertools.pairwise(versions):
        if before.split(".")[0] == after.split(".")[0]:
            assert packs.packs()[before].items() <= packs.packs()[after].items(), after


@pytest.mark.parametrize(
    "values", [{"block.density": 2701.0}, {"contact.stiffness": 1.01e9}, {"time.step": 0.001}, {"time.steps": 49}]
)
def test_another_question_has_another_digest(values):
    one = problem("locked")
    assert digest(replace(one, scene=one.scene.with_values(values))) != digest(one)
    fewer = one.scene.with_values({"run.columns": ["displacement"]})
    assert digest(replace(one, scene=fewer)) != digest(one)


def test_an_answer_to_an_earlier_pack_stands_where_the_question_is_the_same(monkeypatch):
    now = packs.packs()[PACK]
    earlier = {"1.9": {"locked": "0" * 16, "opening": now["opening"], "gone": "1" * 16}, PACK: now}
    monkeypatch.setattr(packs, "packs", lambda: earlier)
    assert stale("1.9", "opening") is None
    changed, gone = stale("1.9", "locked"), stale("1.9", "gone")
    assert "1.9" in changed and PACK in gone and changed != gone
