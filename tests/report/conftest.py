"""What tests of the report share."""

import os
from collections.abc import Callable
from pathlib import Path
from pprint import pformat
from typing import Any

import pytest
from matplotlib.figure import Figure
from oracles.made_cases import between, kept_study, made_history, made_row

from validation.engine.finished import Finished
from validation.gates.gate import Gate, judge
from validation.report.blocks import Blocks
from validation.report.figures import histories
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.suite.folders import get_study


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> dict[str, Figure]:
    """Catch the figures that a chapter writes, by the names of their files."""
    caught: dict[str, Figure] = {}
    monkeypatch.setattr(histories, "save", lambda figure, path: caught.setdefault(path.name, figure))
    return caught


@pytest.fixture
def kept() -> Callable[[str, Blocks], None]:
    """Hold blocks of made rows to a page in `pages`, word by word; with ``KEEP_PAGES=1`` it is written anew."""

    def check(name: str, blocks: Blocks) -> None:
        page = Path(__file__).with_name("pages") / f"{name}.txt"
        text = "\n".join(pformat(block, width=120) for block in blocks) + "\n"
        if os.environ.get("KEEP_PAGES"):
            page.write_text(text, encoding="utf-8")
        assert text == page.read_text(encoding="utf-8")

    return check


def cases(name: str, *metrics: dict[str, Any]) -> list[Any]:
    """Return cases of a scene with rows of DDA, and of the bar where its first peak is given."""
    kept = []
    for scene, own in zip(load_scene(name).expand(), metrics, strict=False):
        bar = {"pressure.peak": own.pop("bar")} if "bar" in own else {}
        history = made_history(scene.time.step, [-0.01] * 4)
        kept += [(scene, made_row(solver, row, scene.name), history) for solver, row in (("dda", own), ("bar", bar))]
    return kept


@pytest.fixture(scope="session")
def core_results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """The study `core` with all that the first pages speak of, its rows in closed form computed."""
    results = Results(tmp_path_factory.mktemp("front"))
    forms = [
        {"pressure.static": 5e6, "pressure.minimum": least, "mode1.damping": xi, "pressure.peak": peak, "bar": bar}
        for least, xi, peak, bar in (
            (1e6, 0.372, 6.3e6, 7e6),
            (1e5, 0.16, 8.4e6, 8e6),
            (-4e5, 0.08, 9e6, 8e6),
            (-1.4e6, 0.009, 11e6, 10e6),
        )
    ]
    stiff = {"displacement.fine_settling_step": 41.0, "pressure.fine_settling_step": 157.0}
    settled = [{"displacement.settling_step": float(n), "pressure.settling_step": n + 3.0} for n in (44, 22, 21)]
    kept = [
        *cases("model-form", *forms),
        *cases("figures-3-4", *({"mode1.damping": xi} for xi in (0.372, 0.16, 0.0845))),
        *cases("figures-5-6", *settled[:2], settled[2] | stiff),
        *cases("figure-9", {"mode1.measured_damping": 1e-12}, {"mode1.measured_damping": 0.123}),
    ]
    names = list(dict.fromkeys(scene.name for scene, *_ in kept if scene.name.startswith("model-form")))
    pairs = []
    errors = ((0.008, 0.007), (0.036, 0.04), (0.09, 0.1), (0.64, 0.74))
    for i, (name, (v, p)) in enumerate(zip(names, errors, strict=True)):
        pairs.append(between(name, "dda", "bar", displacement_l2=v, pressure_l2=p))
        pairs.append(between(name, "bar", "continuum", displacement_l2=0.5 + i / 10, pressure_l2=0.7))
    core = get_study("core")
    rows = {(row.scene, row.solver): row for _, row, _ in kept}
    scenes = {"figures-3-4", *(scene for scene, _ in rows)}
    recipes = {(row.scene, row.name): row for row in core.derived()
               if row.scene in scenes and row.name != "damping" and rows.keys() >= {*row.needs}}  # fmt: skip
    finished = Finished(rows, results, recipes)
    derived = [{"scene": scene, "name": name, "metrics": finished.row(scene, name).metrics} for scene, name in recipes]
    kept_study(results, kept, pairs, study="core", derived=derived, data=core.data())
    gates = [Gate(names[-1], ("dda", "bar"), "pressure.l2", 0, 1, "so", until=until) for until in (0.2, 0.02)]
    results.write_verdicts("core", [judge(gate, gate.until).record("core") for gate in gates])
    return results
