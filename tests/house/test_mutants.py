"""The script of `make mutants`: what it changes, that a sample is its seed's, and that a survivor is shown."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
from conftest import script

CODE = """
def more(x: int | None) -> int | None:
    y: int | None = x
    return y + 1
"""
ASSERTION = "from dda.code import more\n\n\ndef test_more() -> None:\n    assert more(3) == 4\n"


@pytest.fixture
def mutants(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[ModuleType]:
    """Load the script for a repository of one function."""
    pytest.importorskip("cosmic_ray", reason="mutants are NOT RUN: needs cosmic-ray: pip install -e '.[mutants]'")
    module = script("mutants", monkeypatch)
    for name in ("dda", "fem_reference", "validation", "tests/dda"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "dda/code.py").write_text(CODE)
    monkeypatch.setattr(module, "ROOT", tmp_path)
    yield module


def commit(repository: Path, assertion: str) -> None:
    (repository / "tests/dda/test_code.py").write_text(assertion)
    git = ["git", "-c", "user.name=x", "-c", "user.email=x@example.org"]
    for words in (["init", "--quiet"], ["add", "--all"], ["commit", "--quiet", "--message", "x"]):
        subprocess.run([*git, *words], cwd=repository, check=True)


def test_annotations_are_not_changed(mutants: ModuleType) -> None:
    places = mutants.mutants_of(Path("dda/code.py"))
    assert {line for line, _ in places} == {4}
    assert any("NumberReplacer" in mutant.operator_name for listed in places.values() for mutant in listed)


def test_a_sample_is_its_seed_s(mutants: ModuleType) -> None:
    rooms = mutants.all_rooms()
    drawn = [[mutant for _, mutant in mutants.sample(rooms, 5, seed)] for seed in (3, 3, 4)]
    assert drawn[0] == drawn[1] != drawn[2]
    assert len({(mutant.operator_name, mutant.occurrence) for mutant in drawn[0]}) == 5


@pytest.mark.parametrize(("assertion", "status"), [(ASSERTION, 0), ("def test_none() -> None:\n    pass\n", 1)])
def test_a_survivor_is_shown_and_a_status(
    mutants: ModuleType,
    assertion: str,
    status: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    commit(tmp_path, assertion)
    monkeypatch.setattr(sys, "argv", ["mutants", "--rooms", "dda", "--count", "2", "--seed", "2"])
    with pytest.raises(SystemExit) as stopped:
        mutants.main()
    printed = capsys.readouterr().out
    assert stopped.value.code == status
    assert f"2 mutants, {2 * status} alive" in printed
    assert ("+    return y" in printed) is bool(status)
    assert (tmp_path / "dda/code.py").read_text() == CODE
