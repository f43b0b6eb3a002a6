"""What `new` writes: a scene that loads and runs, with springs and steps by their closed forms."""

import pytest
from conftest import refused, thinned, typed

from validation import load_scene, solve
from validation.advice.draft import GLUED_BODIES, KINDS, MOVING
from validation.runs.run import Outcome
from validation.scenes.plausibility import plausibility_warnings


@pytest.mark.parametrize(("kind", "rock"), thinned([("slope", "shale"), *((kind, "granite") for kind in KINDS)], 20))
def test_a_scene_is_written_that_loads_runs_and_warns_of_nothing(kind, rock, tmp_path):
    done = typed("new", "mine.toml", "--kind", kind, "--rock", rock, cwd=tmp_path)
    following = "show" if kind in (*MOVING, *GLUED_BODIES) else "advise"
    assert done.returncode == 0 and f"{following} mine.toml" in done.stdout
    scene = load_scene(tmp_path / "mine.toml")
    assert not [*plausibility_warnings(scene)]
    short = scene.with_values({"time.steps": 3})
    for solver in scene.run.solvers:
        assert solve(short, solver).outcome is Outcome.COMPLETED
    before = (tmp_path / "mine.toml").read_bytes()
    assert "mine.toml" in refused("new", "mine.toml", cwd=tmp_path)
    assert (tmp_path / "mine.toml").read_bytes() == before


def test_numbers_that_do_not_go_together_are_refused_before_a_file_is_written(tmp_path):
    assert "plane.plate" in refused("new", "mine.toml", "--kind", "plate", "--hole", "3", cwd=tmp_path)
    assert not (tmp_path / "mine.toml").exists()
