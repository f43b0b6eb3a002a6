"""A history beside elements on a fine mesh: candidates are found on a coarse one, and borne out on the scene's own."""

from collections import Counter

import numpy as np
import pytest
from faults import seams

from validation import load_scene, solve
from validation.diagnosis.other_solvers import COARSE, SolverSearch
from validation.diagnosis.reading import Stepping
from validation.diagnosis.readings import Reading

STEPS = 20


@pytest.fixture
def runs(monkeypatch):
    """Count the runs of a search by the elements of their mesh."""
    counted = Counter()
    solved = SolverSearch.solved

    def counting(self, *arguments):
        counted[self.scene.fem.per_side] += 1
        return solved(self, *arguments)

    monkeypatch.setattr(SolverSearch, "solved", counting)
    return counted


def explanations(columns):
    s = fine_scene()
    stepping = Stepping(np.full(STEPS, s.time.step), np.arange(STEPS))
    return SolverSearch(s, Reading(stepping, columns), "fem").explanations()


def fine_scene():
    mesh = {"fem.elements": COARSE + 2, "fem.degree": 1, "block.poisson": 0.25}
    return load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": STEPS} | mesh)


@pytest.mark.long
def test_a_number_is_found_on_a_coarse_mesh_and_borne_out_on_the_fine_one(runs, monkeypatch):
    seams.RIVAL_SLIPS.put(monkeypatch, {"young-factor", "density-factor"})
    s = fine_scene()
    theirs = solve(s.with_values({"block.density": 1.4 * s.block.density}), "fem")
    best, *others = explanations(np.array([theirs.displacement, theirs.contact_pressure]))
    assert (best.id, best.value, best.explains) == ("density-factor", pytest.approx(1.4, rel=1e-6), True)
    assert not any(other.explains for other in others)
    assert runs[COARSE + 2] < runs[COARSE]
