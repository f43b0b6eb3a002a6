"""The engine of docs/problems.md: it runs as it stands, and the page's table of problems is the code's."""

import math
import re
from pathlib import Path

import pytest
from oracles.box_scenes import box_scene

from validation.models.plane.problems import box_problems

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "problems.md").read_text(encoding="utf-8")
GRAVITY = 9.81


@pytest.fixture
def engine(tmp_path, monkeypatch):
    """Return the solve of the example of rigid boxes."""
    code = (DOCS / "examples/judge/impulses.py").read_text(encoding="utf-8")
    names = {}
    exec(compile(code, "impulses.py", "exec"), names)
    solve = names["Impulses"]().solve
    return solve


def scene(box, steps=50, boxes=1, **values):
    return box_scene(*[{"density": 2500.0} | box] * boxes, steps=steps, **values)


def test_it_bounces_as_asked(engine, restitution=0.5):
    """The speed of landing is that at the end of the step of 1 ms in which it lands: g dt of 1.4 m/s, 0.7 %."""
    history = engine(scene({"lift": 0.1}, restitution=restitution))
    landing = math.sqrt(2 * GRAVITY * 0.1)
    after = round(landing / GRAVITY / 0.01) + 2
    height = history["box_1.y"][after:].max() - 0.5
    assert math.sqrt(max(0.0, height) / 0.1) == pytest.approx(restitution, abs=0.015)


def test_it_refuses_what_it_cannot_express(engine):
    for other in (scene({}, boxes=2), scene({}, stiffness=1e6)):
        with pytest.raises(NotImplementedError):
            engine(other)


def numbers(text):
    return [float(number) for number in re.findall(r"(?<![\w.])\d+(?:\.\d+)?(?:e-?\d+)?", text)]


def half_band(quantity):
    return max(quantity.high - quantity.exact, quantity.exact - quantity.low)


def test_the_table_of_problems_has_every_problem_with_its_bands():
    rows = dict(re.findall(r"^\| `([\w-]+)` \| [^|]* \| [^|]* \| ([^|]*) \|$", PAGE, re.MULTILINE))
    exact = dict(re.findall(r"^\| `([\w-]+)` \| [^|]* \| ([^|]*) \| [^|]* \|$", PAGE, re.MULTILINE))
    for name, problem in box_problems().items():
        quantities = [one for one in problem.quantities(problem.scene()) if not one.optional]
        stated = numbers(rows[name])
        for quantity in quantities:
            unit = 100.0 if f"{100 * half_band(quantity):g} %" in rows[name] else 1.0
            assert any(math.isclose(unit * half_band(quantity), one, rel_tol=5e-3) for one in stated), quantity.name
            if quantity.exact not in (0.0, 1.0) and name != "restitution":
                assert any(math.isclose(quantity.exact, one, rel_tol=2e-3) for one in numbers(exact[name]))
