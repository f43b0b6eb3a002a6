"""The walls of the house: who may import whom, and what an import costs."""

import json
import re
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest
from conftest import typed
from oracles.answers import answered

from validation.runs.extras import EXTRA_OF, PROJECTS

ROOT = Path(__file__).parents[2]
IMPORT = re.compile(r"^ *(?:from (\w+)[\w.]* import |import (\w+)[\w.]*(?: as \w+)?$)", re.M)
STEPS = {  # what one interpreter does, the lighter before the heavier
    "bare": "",
    # typer ends a help page by an exception of its own: what main() imports counts as well
    "help page": """
import sys
from validation.cli import main
sys.argv = ["dda-validate", "--help"]
try:
    main()
except SystemExit:
    pass
""",
    "plug-in": "import validation.entry.plugin",
    "dda": "import dda",
}
HEAVIER = {
    "scene of dda": """
from validation import load_scene, solve
solve(load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 4}), "dda")
""",
    "bar": "import fem_reference.exact.bar",
}
TYPER = {
    "typer",
    "click",
    "rich",
    "attr",  # which rich imports where it is installed
    "pygments",
    "markdown_it",
    "mdurl",
    "shellingham",
    "annotated_doc",
    "typing_extensions",
}


@cache
def text(path):
    """Return what stands in a file."""
    return path.read_text(encoding="utf-8")


def imports(path):
    """Return the top-level packages that a file imports, anywhere in it."""
    return {name for names in IMPORT.findall(text(path)) for name in names if name}


def modules(steps):
    """Return the modules that one fresh interpreter holds after each of some steps, by its name."""
    shown = "\nimport sys; print('\\nloaded:', *sys.modules)"
    code = "\n".join(f"{code}{shown}" for code in steps.values())
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    lines = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("loaded: ")]
    return dict(zip(steps, map(set, lines), strict=True))


def packages(names):
    """Return the packages among modules that are not of the standard library."""
    return {name.partition(".")[0] for name in names} - set(sys.stdlib_module_names)


@pytest.mark.parametrize(
    ("package", "allowed"),
    [
        ("dda", {"dda", "numpy", "scipy", "numba"}),
        ("fem_reference", {"fem_reference", "numpy", "scipy", "skfem", "meshio", "flint", "numba"}),
    ],
)
def test_a_solver_package_imports_only_what_it_may(package, allowed):
    standard = set(sys.stdlib_module_names)
    for path in (ROOT / package).rglob("*.py"):
        if path.parent.name != "fenicsx":
            compiles = {"numba"} if path == ROOT / "dda/march/compiled.py" else set()
            assert imports(path) <= allowed | standard | compiles, path.name


# Runs commands in one process in which the libraries of the extras cannot be imported; each with its status and errors.
WITHOUT_EXTRAS = """
import contextlib, io, json, sys
from validation.runs.extras import EXTRA_OF

class Blocker:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {*EXTRA_OF, "pytest"}:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Blocker())
from validation.cli import main
ended = []
for arguments in json.loads(sys.argv[1]):
    sys.argv = ["dda-validate", *arguments]
    output, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
        try:
            main()
        except SystemExit as end:
            status = end.code
    ended.append((status, output.getvalue(), errors.getvalue()))
print(json.dumps(ended))
"""
# What a plain install does, in this order.
LIGHT = """
--help
list
list solvers
show figures-3-4
solve figures-3-4 --set time.step=0.01 --csv history.csv
solve figures-3-4 --set time.step=0.01 --solver fem
compare figures-3-4 history.csv --set time.step=0.01
solve pentagon --csv pentagon.csv
compare pentagon pentagon.csv
run figures-3-4 --set time.step=0.01 --results results
rows figures-3-4 --results results
diff results results
judge answer
judge answer/rocking.csv rocking
judge dda standing rocking
advise damping figures-3-4 --set time.step=0.01
advise response figures-3-4 --set time.step=0.01
advise contact figures-3-4 --set time.step=0.01 --set time.steps=5 --set contact.law=unilateral
advise step figures-3-4 --set time.step=0.01 --set time.steps=5 --damping 0.05
"""
# What it does not, after the extra that does.
HEAVY = """
report: report --results results
mesh: solve pentagon --solver fem
exact: solve figures-3-4 --set time.step=0.01 --solver block-events
report: report --results results --site site
report: report --results results --figures figures
report: compare figures-3-4 history.csv --out page.pdf
report: compare figures-3-4 history.csv --figure figure.svg
report: advise response figures-3-4 --set time.step=0.01 --figure response.svg
report: judge answer --out page
report: judge answer --out page.pdf
exact: solve figures-3-4 --set time.step=0.01 --solver dda-60
exact: export-pack pack
mesh: solve figures-3-4 --set time.step=0.01 --solver fem --fields fields.vtu
"""


def ended(place, lines):
    """Return status, output and errors of command lines without the libraries of the extras."""
    command = [sys.executable, "-c", WITHOUT_EXTRAS, json.dumps([line.split() for line in lines])]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=place)
    return json.loads(done.stdout.splitlines()[-1])


FILLED = {  # by a search or a run
    "dda/bodies/glued_step.py",
    "fem_reference/contact/stepper.py",
    "fem_reference/events/bars_march.py",
    "fem_reference/events/switches.py",
    "fem_reference/scheme/newmark.py",
    "validation/diagnosis/beside.py",
    "validation/diagnosis/stepping.py",
    "validation/engine/run.py",
    "validation/problems/cause.py",
    "validation/problems/models.py",
}
UNEQUAL = {  # where a list may end before the one beside it
    "dda/bodies/block_system.py",
    "fem_reference/events/bars_events.py",
    "fem_reference/exact/continuum.py",
    "fem_reference/exact/damped.py",
    "fem_reference/exact/sliding_block.py",
    "fem_reference/plane/contact.py",
    "validation/advice/plain.py",
    "validation/diagnosis/answer.py",
    "validation/diagnosis/beside.py",
    "validation/diagnosis/evidence.py",
    "validation/diagnosis/judgement.py",
    "validation/models/plane/fields.py",
    "validation/models/plane/meshed.py",
    "validation/report/chapters/damping.py",
    "validation/report/figures/charts.py",
    "validation/studies/standing/formulas.py",
    "validation/theory/corner_impact.py",
}


def test_records_are_frozen_and_zips_strict_but_where_it_is_meant():
    places = [path for package in ("dda", "fem_reference", "validation") for path in (ROOT / package).rglob("*.py")]
    texts = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in places}
    decorated = re.compile(r"^@dataclass(?!\(.*frozen=True)", re.MULTILINE)
    assert {name for name, text in texts.items() if decorated.search(text)} == FILLED
    assert {name for name, text in texts.items() if "strict=False" in text} == UNEQUAL


@pytest.mark.long
def test_a_plain_install_judges_and_compares(tmp_path):
    answered(tmp_path / "answer", 1.001, ("rocking", "column"))
    lines = LIGHT.strip().splitlines()
    for line, (status, output, errors) in zip(lines, ended(tmp_path, lines), strict=True):
        assert status == 0, (line, errors)
        assert "Traceback" not in output + errors
        assert ("meshio" in output) == line.startswith("compare pentagon")
    written = {path.name for path in tmp_path.iterdir()}
    assert written == {"answer", "history.csv", "pentagon.csv", "results", "rows.csv"}


def check_named(extra, status, errors):
    """A command ended as bad input, by one line that names the extra."""
    assert status == 2, errors
    (line,) = (line for line in errors.splitlines() if "warning" not in line)
    assert line.startswith("error: ")
    assert line.endswith(f"'dda-validation[{extra}]'")


def test_an_extra_that_is_absent_is_named_before_anything_is_imported(tmp_path, monkeypatch):
    monkeypatch.setattr("validation.runs.extras.is_installed", lambda library: False)
    (tmp_path / "history.csv").write_text("time,displacement\n0.01,-0.01\n")
    for row in HEAVY.strip().splitlines():
        extra, line = row.split(": ")
        done = typed(*line.split(), cwd=tmp_path)
        check_named(extra, done.returncode, done.stderr)


def test_extras_bring_what_they_say_and_a_plain_install_brings_none_of_it():
    project = tomllib.loads(text(ROOT / "pyproject.toml"))["project"]
    extras = project["optional-dependencies"]
    projects = {library: PROJECTS.get(library, library) for library in EXTRA_OF}
    for library, extra in EXTRA_OF.items():
        assert [row for row in extras[extra] if row.startswith(f"{projects[library]}>=")], library
    assert not [row for row in project["dependencies"] if row.partition(">=")[0] in {*projects.values(), "pytest"}]
    assert sorted(re.split(r"[\[\],]", *extras["all"])[1:-1]) == sorted({*EXTRA_OF.values(), "gates"})


@pytest.mark.long
def test_a_scene_of_dda_needs_no_finite_elements_and_the_bar_no_ball_arithmetic():
    loaded = modules(HEAVIER)
    assert not packages(loaded["scene of dda"]) & {"skfem", "matplotlib", "fem_reference", "typst", "meshio"}
    assert not packages(loaded["bar"]) & {"skfem", "meshio", "matplotlib", "flint"}


@pytest.mark.long
def test_start_up_loads_little():
    """What bounds its time on any machine: the libraries by name, and how many modules beside those of a bare start."""
    bare, page, plugin, dda = modules(STEPS).values()
    assert not packages(plugin) & {"numpy", "scipy", "pydantic"}
    assert packages(dda - plugin) == {"numpy", "dda"}
    assert len([name for name in dda if name.startswith("dda")]) < 90  # 50
    assert packages(page - bare) <= {"validation"} | TYPER
    assert len(own := {name for name in page if name.startswith("validation")}) < 35, own  # 22
    assert len(page - bare) < 400  # 270
