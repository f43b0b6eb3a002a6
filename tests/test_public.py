"""The names that Python's users import: their list, version, types, the shape of a solution and its errors."""

import ast
import pickle
import re
from importlib.metadata import version
from pathlib import Path

import pytest

import validation
from validation import InputError, Outcome, Run, load_scene, solve

DOCS = Path(__file__).parents[1] / "docs/python.md"


@pytest.fixture
def scene():
    return load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 20})


@pytest.fixture
def solution(scene):
    return solve(scene, "dda")


def test_dir_lists_the_public_names_and_all_of_them_load():
    assert set(validation.__all__) < set(dir(validation)) and "__version__" in dir(validation)
    assert not {name for name in dir(validation) if name.startswith("_")} - {"__version__"}
    assert all(getattr(validation, name) is not None for name in dir(validation))
    assert validation.__version__ == version("dda-validation")
    for name in ("solve", "damping", "advise", "response"):
        assert pickle.loads(pickle.dumps(getattr(validation, name))) is getattr(validation, name)


def test_type_checkers_see_the_names_that_are_loaded():
    """The names behind `TYPE_CHECKING` are those of the table, from the modules of the table."""
    tree = ast.parse(Path(str(validation.__file__)).read_text(encoding="utf-8"))
    imports = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.names[0].asname:
            imports[node.names[0].name] = str(node.module).removeprefix("validation.")
    assert imports == validation._NAMES


def test_the_page_of_python_names_each_of_them():
    text = DOCS.read_text(encoding="utf-8")
    assert [name for name in dir(validation) if f"`{name}" not in text] == []


def test_a_solution_is_a_run_with_a_short_text(scene, solution):
    assert isinstance(solution, Run) and (solution.scene, solution.solver) == (scene, "dda")
    peak = min(solution.displacement)
    assert re.match(rf"<Solution: dda .* {scene.name}, 20 .* {peak:.4g} m, ", repr(solution))
    assert repr(solution).endswith(" s>")
    unstable = {"time.alpha": 0.0, "time.delta": 0.5, "time.step": 0.1, "time.steps": 500, "time.allow_unstable": True}
    grown = solve(scene.with_values(unstable), "dda")
    assert grown.outcome is not Outcome.COMPLETED and str(grown.outcome) in repr(grown)


def test_columns_are_plotted_with_labelled_axes(solution, tmp_path):
    figure = solution.plot(path=tmp_path / "history.svg")
    labels = [axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes]
    assert [re.findall(r"\[(\w+)\]", label) for label in labels] == [["s", "m"], ["s", "Pa"]]
    drawn = figure.axes[0].get_lines()[0]
    assert list(drawn.get_xdata()) == list(solution.time) and list(drawn.get_ydata()) == list(solution.displacement)
    assert (tmp_path / "history.svg").read_text(encoding="utf-8").lstrip().startswith("<?xml")
    assert len(solution.plot(["contact_pressure"]).axes) == 1


@pytest.mark.parametrize(("options", "field"), [({"columns": ["speed"]}, "columns"), ({"path": "x.gif"}, "path")])
def test_what_cannot_be_plotted_is_refused(solution, options, field):
    with pytest.raises(InputError) as refused:
        solution.plot(**options)
    assert refused.value.field == field


def test_what_is_no_name_of_the_package_is_an_attribute_error():
    with pytest.raises(AttributeError, match="'nothing'"):
        _ = validation.nothing
