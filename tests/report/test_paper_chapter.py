"""The chapter of the study `paper`: the register of claims, and figures from results made by hand."""

from functools import cache

import numpy as np
from oracles.made_cases import kept_study, made_history, made_row

from validation.report.blocks import FigureBlock, Paragraph
from validation.report.chapters.registry import chapter_of
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.suite.folders import get_study

BASE = load_scene("figures-3-4")


@cache
def curves():
    """Return what the figures draw beside histories."""
    return dict(get_study("paper").data())


def named(scene, **values):
    """Return a case of a scene; its name is that of the scene."""
    return BASE.with_values(values).model_copy(update={"name": scene})


def page(place, *cases, claims=None, **kept):
    """Return the chapter of a study that has these cases and claims."""
    results = Results(place)
    triples = [
        (scene, made_row(solver, metrics[solver], scene.name), histories.get(solver))
        for scene, metrics, histories in cases
        for solver in metrics
    ]
    rows = [{"scene": "claims", "name": name, "metrics": metrics} for name, metrics in (claims or {}).items()]
    manifest = kept_study(
        results, triples, study="paper", data=curves(), derived=[*rows, *kept.pop("derived", ())], **kept
    )
    return chapter_of("paper")(results, manifest, place)


# ---- the register ---------------------------------------------------------------------------------------------------


def test_claims_have_verdict_reason_and_numbers_and_the_lead_counts_them(kept, drawn, tmp_path):
    """Also where all hold or none, and where one or several of the refuted are misprints."""
    claims = {
        "S16": {"verdict": 0.0, "steps": 44, "none": 0, "share": "undefined"},
        "C1": {"verdict": 2.0, "left": 0.001, "nothing": 1e-15},
        "C6": {"verdict": 1.0},
    }
    blocks = page(tmp_path, claims=claims)
    counted = (
        {"C1": 2.0, "C6": 1.0, "C2": 0.0},
        {"C1": 2.0, "C3": 2.0, "S16": 0.0},
        {"C2": 0.0, "S16": 0.0, "S20": 0.0},
    )
    for verdicts in counted:
        others = page(tmp_path, claims={name: {"verdict": verdict} for name, verdict in verdicts.items()})
        blocks.append(next(block for block in others if isinstance(block, Paragraph)))
    kept("claims", blocks)


# ---- figures 3 to 9 -------------------------------------------------------------------------------------------------


def test_figures_begin_at_step_one_in_their_units_and_name_what_is_left_out(kept, kept_figures, drawn, tmp_path):
    """The continuum is left out of Figures 3 and 4, where its period has too few steps."""
    metrics = {"displacement.static": -0.01, "pressure.static": 5e6, "displacement.settling_step": 12.0}
    steps = np.arange(1, 301)
    cases = []
    for name in ("figures-3-4", "figures-5-6", "figure-7", "figure-8", "figure-9"):
        histories = {solver: made_history(0.002, -steps / size, 1e4 * steps + size) for solver, size in
                     (("dda", 2e4), ("bar", 3e4), ("continuum", 5e4))}  # fmt: skip
        own = metrics if name == "figures-3-4" else metrics | {"pressure.settling_step": 17.0}
        cases.append((named(name, **{"time.step": 0.002}), {"dda": own, "bar": {}, "continuum": {}}, histories))
    words = {"figures-3-4": "none", "figures-5-6": "curve"}
    derived = [{"scene": name, "name": "period", "metrics": {"continuum": word}} for name, word in words.items()]
    blocks = page(tmp_path, *cases, derived=derived)
    kept("paper", [block for block in blocks if isinstance(block, FigureBlock)])
    kept_figures("figures-paper", drawn)
