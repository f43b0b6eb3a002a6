"""The key of a kept row covers everything that enters the row: sources of every room, measures, records, versions."""

from pathlib import Path

import pytest

from validation.engine import case as case_module
from validation.engine.case import Case
from validation.scenes.scene import load_scene
from validation.solvers.fenicsx import FEniCSx


def test_an_edited_source_gives_another_key_to_the_solvers_that_it_enters(scene, monkeypatch):
    def keys():
        case_module.source_digest.cache_clear()
        return [Case(scene, solver).key() for solver in ("dda", "fem")]

    before = keys()
    read = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda path: read(path) + b"# more" * ("dda/bodies" in path.as_posix()))
    assert [a == b for a, b in zip(before, keys(), strict=True)] == [False, True]
    case_module.source_digest.cache_clear()


def test_what_a_solver_does_not_read_is_no_part_of_its_key(scene):
    other = scene.with_values({"time.alpha": 0.37})
    same = [Case(scene, solver).key() == Case(other, solver).key() for solver in ("continuum", "dda")]
    assert same == [True, False]


def keys_of(scene, solver, file, texts):
    """Return the keys of a scene as a file that it names has one content and another."""
    keys = set()
    for text in texts:
        file.write_text(text)
        keys.add(Case(scene, solver).key())
    return keys


@pytest.mark.parametrize(
    ("name", "field", "solver", "column"),
    [("figures-3-4", "load.base_motion", "dda", "x"), ("waves-site", "input.record", "layers", "velocity")],
)
def test_the_content_of_a_record_enters_the_key(name, field, solver, column, tmp_path):
    record = tmp_path / "record.csv"
    moved = load_scene(name).with_values({field: str(record)})
    texts = f"time,{column}\n0,0\n1,0.1\n", f"time,{column}\n0,0\n1,0.2\n"
    assert len(keys_of(moved, solver, record, texts)) == 2


def test_the_content_of_a_mesh_enters_the_key_of_who_reads_it(scene, tmp_path):
    mesh = tmp_path / "block.msh"
    meshed = scene.with_values({"fem.mesh": str(mesh)})
    assert len(keys_of(meshed, "fem", mesh, ("one", "another"))) == 2
    assert len(keys_of(meshed, "dda", mesh, ("one", "another"))) == 1


@pytest.mark.long
def test_versions_of_the_libraries_enter_the_key(scene, monkeypatch):
    before = {solver: Case(scene, solver).key() for solver in ("dda", "fem", "fenicsx")}
    monkeypatch.setattr(FEniCSx, "versions", lambda self: {"dolfinx": "another"})
    assert Case(scene, "fenicsx").key() != before["fenicsx"] and Case(scene, "fem").key() == before["fem"]
    for library in ("numpy", "scipy", "scikit-fem", "meshio", "python-flint"):
        sound = case_module.library_versions()
        assert sound[library][0].isdigit()
        monkeypatch.setattr(case_module, "library_versions", lambda: sound | {library: "another"})  # noqa: B023
        assert Case(scene, "dda").key() != before["dda"], library
        monkeypatch.setattr(case_module, "library_versions", lambda: sound)  # noqa: B023
