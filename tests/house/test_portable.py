"""The script that does the rounds: what it installs, and that a red round is told, logged and a status."""

import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
from conftest import script


@pytest.fixture
def portable(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    yield script("portable", monkeypatch)


def test_the_lowest_versions_are_those_that_are_declared(portable: ModuleType) -> None:
    lowest, newest = portable.requirements(lowest=True), portable.requirements(lowest=False)
    assert len(lowest) == len(newest) > 12
    assert all("==" in text and ">=" not in text for text in lowest), "a bound that the lowest round cannot read"
    assert any(text.startswith("numpy>=") for text in newest)


@pytest.mark.long
def test_the_rounds_reach_every_kernel_version_and_the_wheel(portable: ModuleType, tmp_path: Path) -> None:
    names = [one.name for one in (*portable.versions(False, tmp_path), *portable.wheel(False, tmp_path))]
    assert names[0].startswith("lowest versions") and names[1].startswith("newest versions") and "wheel" in names[-1]
    assert sys.version_info[:2] in portable.pythons()


def test_a_red_round_is_named_logged_and_a_status(
    portable: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    good = portable.Round("good", [[sys.executable, "-c", "print('fine')"]])
    bad = portable.Round("bad", [[sys.executable, "-c", "print('ERROR why'); raise SystemExit(3)"], ["never"]])
    monkeypatch.setattr(portable, "kernels", lambda short: [good, portable.Round("same", [])])
    monkeypatch.setattr(portable, "versions", lambda short, work: [bad])
    monkeypatch.setattr(portable, "wheel", lambda short, work: [])
    monkeypatch.setattr(sys, "argv", ["portable", "--work", str(tmp_path)])
    with pytest.raises(SystemExit) as stopped:
        portable.main()
    said = capsys.readouterr().out
    assert stopped.value.code == 1 and "2 rounds, 1 red: bad" in said
    assert "ERROR why" in said and str(tmp_path / "bad.log") in said
    assert "ERROR why" in (tmp_path / "bad.log").read_text() and "fine" in (tmp_path / "good.log").read_text()
    for only, status in (("good", 0), ("same", 1), ("nothing", 1)):  # no round at all is no success
        monkeypatch.setattr(sys, "argv", ["portable", "--work", str(tmp_path), "--only", only])
        with pytest.raises(SystemExit) as stopped:
            portable.main()
        assert stopped.value.code == status
