"""What adapters hand over: data of a scene to a solver, counts and notes of a run back."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import scene_of

from fem_reference.exact.bar import applicable
from validation.runs.modes import contact_index
from validation.scenes.scene import Scene
from validation.solvers.dda import SubBlocks, model_of
from validation.solvers.fem import problem_of
from validation.solvers.registry import get_solver
from validation.solvers.translation import to_run


def test_a_run_keeps_every_count_second_and_note_of_a_solver_under_its_name(scene: Scene) -> None:
    time = np.array([0.1, 0.2])
    columns = {"displacement": np.array([-1.0, -2.0]), "contact_pressure": np.array([3.0, 4.0]), "rotation": time}
    result = SimpleNamespace(
        time=time, columns=columns, unknowns=2, nonzeros=3, factorisations=5, solves=7, notes=("own",),
        setup_seconds=11.0, stepping_seconds=13.0, estimate=17.0,
    )  # fmt: skip
    run = to_run(scene, result)
    assert dict(run.work) == {"unknowns": 2, "nonzeros": 3, "factorisations": 5, "solves": 7, "steps": 2}
    assert dict(run.seconds) == {"setup": 11.0, "stepping": 13.0}
    assert (run.notes, run.estimate) == (("own",), 17.0)
    assert run.history is not None and set(run.history.columns) == {"displacement", "contact_pressure"}
    del result.estimate
    assert to_run(scene, result).estimate is None


@pytest.mark.parametrize("changes", [{"traction": 1.0}, {"gravity": 1.0}, {"eccentricity": 0.1}], ids=str)
def test_the_bar_takes_a_centred_pressure_alone(tmp_path: Path, changes: dict[str, float]) -> None:
    def problem(**load: object):  # type: ignore[no-untyped-def]
        return problem_of(scene_of(**{f"load__{name}": value for name, value in load.items()}))

    assert applicable(problem()) is None
    assert "centred pressure only" in (applicable(problem(**changes)) or "")
    (tmp_path / "r.csv").write_text("time,y\n0,0\n1,1\n")
    assert "centred pressure only" in (applicable(problem(base_motion=str(tmp_path / "r.csv"))) or "")


def test_a_scene_s_data_reach_the_block_the_glue_and_the_mesh() -> None:
    scene = scene_of(block__young=3e9, contact__shear_stiffness=4e8, block__subdivide=[3, 2], block__glue_ratio=20.0)
    model = model_of(scene)
    assert (model.contact.normal, model.contact.shear) == (1e9, 4e8)
    system = SubBlocks(scene, False).system
    assert system is not None and len(system.blocks) == 6
    lowest = {round(float(b.corners[:, 0].min()), 12) for b in system.blocks}
    assert len(lowest) == 3  # three along the base, two upwards
    inner = [joint for joint in system.joints if joint.second != -1]
    assert {(joint.normal, joint.shear) for joint in inner} == {(6e10, 6e10)}
    cut = SubBlocks(scene_of(block__subdivide=[3, 2], block__pattern="triangles"), False).system
    assert cut is not None and len(cut.blocks) == 12
    problem = problem_of(scene_of(contact__shear_stiffness=4e8, fem__cells="triangles"))
    assert (problem.stiffness, problem.shear_stiffness, problem.cells) == (1e9, 4e8, "triangles")


def test_modes_of_the_block_say_what_contact_pressure_they_carry() -> None:
    """Of a static pressure all modes together carry the whole."""
    modes = get_solver("dda").modes(scene_of())
    assert sum(m.contact_share or 0.0 for m in modes) == pytest.approx(1.0, rel=1e-12)
    assert sum(m.share for m in modes) == pytest.approx(1.0, rel=1e-12)
    assert contact_index(modes) == 1
