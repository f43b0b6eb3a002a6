"""The scripts of `.ci`: rounds on other machines, the archives of a release."""

import subprocess
import sys
import tarfile
import zipfile

import pytest
from conftest import script

# ---- portable -------------------------------------------------------------------------------------------------------


@pytest.fixture
def portable(monkeypatch):
    return script("portable", monkeypatch)


def test_the_lowest_versions_are_those_that_are_declared(portable):
    lowest, newest = portable.requirements(lowest=True), portable.requirements(lowest=False)
    assert len(lowest) == len(newest) > 12
    assert all("==" in text and ">=" not in text for text in lowest)
    assert any(text.startswith("numpy>=") for text in newest)


@pytest.mark.long
def test_the_rounds_reach_every_kernel_version_and_the_wheel(portable, tmp_path):
    names = [one.name for one in (*portable.versions(False, tmp_path), *portable.wheel(False, tmp_path))]
    assert [name.split()[0] for name in names[:2]] == ["lowest", "newest"] and "wheel" in names[-1]
    assert sys.version_info[:2] in portable.pythons()


def test_a_red_round_is_named_logged_and_a_status(portable, tmp_path, monkeypatch, capsys):
    good = portable.Round("good", [[sys.executable, "-c", "print('fine')"]])
    bad = portable.Round("bad", [[sys.executable, "-c", "print('ERROR_WHY'); raise SystemExit(3)"], ["never"]])
    monkeypatch.setattr(portable, "kernels", lambda short: [good, portable.Round("same", [])])
    monkeypatch.setattr(portable, "versions", lambda short, work: [bad])
    monkeypatch.setattr(portable, "wheel", lambda short, work: [])
    statuses = {}
    for only in ("", "good", "same", "nothing"):  # no round at all is no success
        monkeypatch.setattr(sys, "argv", ["portable", "--work", str(tmp_path), "--only", only])
        with pytest.raises(SystemExit) as stopped:
            portable.main()
        statuses[only] = stopped.value.code
    assert statuses == {"": 1, "good": 0, "same": 1, "nothing": 1}
    printed = capsys.readouterr().out
    assert "1 red: bad" in printed and "ERROR_WHY" in printed and str(tmp_path / "bad.log") in printed
    assert "ERROR_WHY" in (tmp_path / "bad.log").read_text() and "fine" in (tmp_path / "good.log").read_text()


def commit(repository):
    git = ["git", "-c", "user.name=x", "-c", "user.email=x@example.org"]
    for words in (["init", "--quiet"], ["add", "--all"], ["commit", "--quiet", "--message", "x"]):
        subprocess.run([*git, *words], cwd=repository, check=True)


# ---- archives of a release ------------------------------------------------------------------------------------------


@pytest.fixture
def dist(monkeypatch):
    return script("dist", monkeypatch)


def test_links_of_a_page_become_addresses_of_a_version(dist):
    page = "![a](docs/a.png) [b](docs/b.md#part) [c](https://example.org/) [d](#here)"
    assert dist.absolute(page, "https://example.org/r/", "1.2.3") == (
        "![a](https://example.org/r/raw/v1.2.3/docs/a.png) [b](https://example.org/r/blob/v1.2.3/docs/b.md#part) "
        "[c](https://example.org/) [d](#here)"
    )


def test_a_release_with_placeholders_or_without_its_tag_is_refused(dist, tmp_path, monkeypatch, capsys):
    assert dist.is_placeholder("https://x.invalid/docs") and not dist.is_placeholder("https://example.org/invalid")
    urls = '[project.urls]\nRepository = "https://x.invalid"\nIssues = "https://example.org"\n'
    (tmp_path / "pyproject.toml").write_text(f'[project]\nname = "x"\nversion = "3.2.1"\n{urls}')
    commit(tmp_path)
    monkeypatch.setattr(dist, "ROOT", tmp_path)
    monkeypatch.setattr(sys, "argv", ["dist", "--release"])
    with pytest.raises(SystemExit) as stopped:
        dist.main()
    complained = capsys.readouterr().err
    assert stopped.value.code == 2 and not (tmp_path / "dist").exists()
    assert "Repository" in complained and "v3.2.1" in complained and "Issues" not in complained
    tag = ["git", "-c", "user.name=x", "-c", "user.email=x@example.org", "tag", "-a", "v3.2.1", "-m", "x"]
    subprocess.run(tag, cwd=tmp_path, check=True)
    assert dist.release_problems("3.2.1", []) == []


def test_archives_that_lack_something_are_told(dist, tmp_path):
    (tmp_path / "file").write_text("x")
    with tarfile.open(tmp_path / "x.tar.gz", "w:gz") as archive:
        for name in dist.REQUIRED[1:]:
            archive.add(tmp_path / "file", f"x-1/{name}")
    with zipfile.ZipFile(tmp_path / "x.whl", "w") as wheel:
        for folder in ("dda", "fem_reference", "dda_validation", "tests", "x-1.dist-info"):
            wheel.writestr(f"{folder}/file", "x")
        for page in set(dist.ROOT.glob("docs/*.md")) - {dist.ROOT / "docs/judge.md"}:
            wheel.writestr(f"x-1.data/data/share/doc/dda-validation/{page.name}", "x")
    missing = [f"x.tar.gz lacks {dist.REQUIRED[0]}"]
    missing += ["x.whl lacks judge.md", "x.whl holds tests", "x.whl lacks validation"]
    assert dist.missing_files(tmp_path / "x.tar.gz", tmp_path / "x.whl") == missing
