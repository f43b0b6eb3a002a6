"""The walls of the house: who may import whom, and what an import costs."""

import ast
import json
import re
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest
from oracles.answers import answered

from validation.runs.extras import EXTRA_OF, PROJECTS

ROOT = Path(__file__).parents[2]
SCENE_OF_DDA_ONLY = """
import sys
from validation import load_scene, solve
scene = load_scene("figures-3-4").with_values({"time.step": 0.002})
solve(scene, "dda")
"""
# typer ends a help page by an exception of its own: what main() imports counts as well
HELP_PAGE = """
import sys
from validation.cli import main
sys.argv = ["dda-validate", "--help"]
try:
    main()
except SystemExit:
    pass
"""
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


def statements(path):
    """Yield the statements of a file, those inside others as well."""
    left = [ast.parse(text(path))]
    while left:
        node = left.pop()
        yield node
        for part in ("body", "orelse", "finalbody", "handlers", "cases"):
            left.extend(getattr(node, part, ()))


@cache
def imports(path):
    """Return the top-level packages that a file imports, anywhere in it."""
    found = set()
    for node in statements(path):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.add(node.module.partition(".")[0])
    return found


@cache
def modules(code):
    """Return the modules that a fresh interpreter holds after some code."""
    shown = "\nimport sys; print('\\n'.join(['', 'loaded:', *sys.modules]))"
    done = subprocess.run([sys.executable, "-c", code + shown], capture_output=True, text=True, check=True, cwd=ROOT)
    return frozenset(done.stdout.partition("\nloaded:\n")[2].split())


def loaded(code):
    """Return the top-level modules that a fresh interpreter holds after some code."""
    return {name.partition(".")[0] for name in modules(code)}


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
CASE = ["figures-3-4", "--set", "time.step=0.01"]
LIGHT = [  # what a plain install does, in this order
    (["--help"], 0),
    (["list"], 0),
    (["list", "solvers"], 0),
    (["show", "figures-3-4"], 0),
    (["solve", *CASE, "--csv", "history.csv"], 0),
    (["solve", *CASE, "--solver", "fem"], 0),
    (["compare", "figures-3-4", "history.csv", "--set", "time.step=0.01"], 0),
    (["solve", "pentagon", "--csv", "pentagon.csv"], 0),
    (["compare", "pentagon", "pentagon.csv"], 0),
    (["run", *CASE, "--results", "results"], 0),
    (["rows", "figures-3-4", "--results", "results"], 0),
    (["diff", "results", "results"], 0),
    (["judge", "dda", "standing"], 0),
    (["judge", "answer"], 0),
    (["judge", "answer/rocking.csv", "rocking"], 0),
    (["judge", "dda", "standing", "rocking"], 0),
    (["advise", "damping", *CASE], 0),
    (["advise", "response", *CASE], 0),
    (["advise", "contact", *CASE, "--set", "contact.law=unilateral"], 0),
    (["advise", "step", *CASE, "--set", "time.steps=5", "--damping", "0.05"], 0),
]
HEAVY = [  # what it does not, and the extra that does
    (["report", "--results", "results"], "report"),
    (["report", "--results", "results", "--site", "site"], "report"),
    (["report", "--results", "results", "--figures", "figures"], "report"),
    (["compare", "figures-3-4", "history.csv", "--out", "page.pdf"], "report"),
    (["compare", "figures-3-4", "history.csv", "--figure", "figure.svg"], "report"),
    (["advise", "response", *CASE, "--figure", "response.svg"], "report"),
    (["judge", "answer", "--out", "page"], "report"),
    (["judge", "answer", "--out", "page.pdf"], "report"),
    (["solve", *CASE, "--solver", "block-events"], "exact"),
    (["solve", *CASE, "--solver", "dda-60"], "exact"),
    (["judge", "dda", "opening"], "exact"),
    (["export-pack", "pack"], "exact"),
    (["solve", "pentagon", "--solver", "fem"], "mesh"),
    (["solve", *CASE, "--solver", "fem", "--fields", "fields.vtu"], "mesh"),
]


def ended(place, table):
    """Status, output and errors of commands without the libraries of the extras, and what goes with them in a table."""
    answered(place / "answer", 1.001, ("rocking", "column"))
    command = [sys.executable, "-c", WITHOUT_EXTRAS, json.dumps([arguments for arguments, _ in table])]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=place)
    return [(*row, *told) for row, told in zip(table, json.loads(done.stdout.splitlines()[-1]), strict=True)]


@pytest.mark.long
def test_a_plain_install_judges_and_compares(tmp_path):
    for arguments, status, reached, output, errors in ended(tmp_path, LIGHT):
        assert reached == status, (arguments, errors)
        assert "Traceback" not in output + errors
        assert ("fem is no candidate: it needs meshio" in output) == (arguments[:2] == ["compare", "pentagon"])
    written = {path.name for path in tmp_path.iterdir()}
    assert written == {"answer", "history.csv", "pentagon.csv", "results", "rows.csv"}


def test_what_needs_an_extra_names_it_in_one_line(tmp_path):
    runs = [row for row in LIGHT if row[0][0] == "run" or "history.csv" in row[0][-1]]
    for arguments, extra, status, _, errors in ended(tmp_path, [*runs, *HEAVY])[len(runs) :]:
        assert status == 2, (arguments, errors)
        (line,) = (line for line in errors.splitlines() if "warning" not in line)
        assert line.startswith("error: ")
        assert line.endswith(f"pip install 'dda-validation[{extra}]'")


def test_extras_bring_what_they_say_and_a_plain_install_brings_none_of_it():
    project = tomllib.loads(text(ROOT / "pyproject.toml"))["project"]
    extras = project["optional-dependencies"]
    projects = {library: PROJECTS.get(library, library) for library in EXTRA_OF}
    for library, extra in EXTRA_OF.items():
        assert [row for row in extras[extra] if row.startswith(f"{projects[library]}>=")], library
    assert not [row for row in project["dependencies"] if row.partition(">=")[0] in {*projects.values(), "pytest"}]
    assert sorted(re.split(r"[\[\],]", *extras["all"])[1:-1]) == sorted({*EXTRA_OF.values(), "gates"})


def test_rooms_say_what_they_are_for():
    for package in ("dda", "fem_reference", "validation"):
        for room in [path.parent for path in (ROOT / package).rglob("__init__.py")]:
            assert ast.get_docstring(ast.parse(text(room / "__init__.py"))), room


FILLED = {"engine/run.py", "diagnosis/beside.py", "diagnosis/stepping.py", "problems/cause.py", "problems/models.py"}


def test_records_are_frozen_but_for_what_a_search_or_a_run_fills():
    modules = {path.relative_to(ROOT / "validation").as_posix(): path for path in (ROOT / "validation").rglob("*.py")}
    decorated = re.compile(r"^@dataclass(?!\(.*frozen=True)", re.MULTILINE)
    assert {name for name, path in modules.items() if decorated.search(path.read_text(encoding="utf-8"))} == FILLED


def test_no_print_no_exit_no_assert_in_library_code():
    for package in ("dda", "fem_reference", "validation"):
        for path in (ROOT / package).rglob("*.py"):
            if path.relative_to(ROOT / package).as_posix() in ("test_gates.py", "cli/entry.py"):
                continue
            if re.search(r"\bassert\b|\b(print|exit)\b *\(", text(path)):
                nodes = list(ast.walk(ast.parse(text(path))))
                assert not [node for node in nodes if isinstance(node, ast.Assert)], path
                calls = [ast.unparse(node.func) for node in nodes if isinstance(node, ast.Call)]
                assert not {"print", "sys.exit", "exit"} & set(calls), path


def test_a_scene_of_dda_alone_imports_no_finite_elements():
    assert not loaded(SCENE_OF_DDA_ONLY) & {"skfem", "matplotlib", "fem_reference", "typst", "meshio"}


def test_the_bar_needs_no_finite_elements_and_no_ball_arithmetic():
    code = "import fem_reference.exact.bar, validation"
    assert not loaded(code) & {"skfem", "meshio", "matplotlib", "flint"}


def test_the_command_line_and_the_plugin_start_light():
    assert not loaded("import validation.entry.plugin") & {"numpy", "scipy", "pydantic", "typer"}
    assert not loaded(HELP_PAGE) & {"numpy", "scipy", "skfem", "matplotlib", "pydantic"}


def test_start_up_loads_little():
    """What bounds its time on any machine: the libraries by name, and how many modules beside those of a bare start."""
    bare, dda, page = (modules(code) for code in ("", "import dda", HELP_PAGE))
    assert packages(dda - bare) == {"numpy", "dda"}
    assert len([name for name in dda if name.startswith("dda")]) < 90  # 50
    assert packages(page - bare) <= {"validation"} | TYPER
    assert len(own := {name for name in page if name.startswith("validation")}) < 35, own  # 22
    assert len(page - bare) < 400  # 270
