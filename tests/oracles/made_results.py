"""Results made by hand, so that a test knows every number that a report should print, and what a figure shows."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.ticker import FuncFormatter
from oracles.made_cases import between, kept_study, made_history, made_row

from validation.engine.finished import Finished
from validation.gates.gate import Gate, Status, Verdict, judge
from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene
from validation.studies.core import decisions
from validation.suite.folders import get_study


def cases(name, *metrics):
    """Return cases of a scene with rows of DDA, and of the bar where its first peak is given."""
    kept = []
    for scene, own in zip(load_scene(name).expand(), metrics, strict=False):
        bar = {"pressure.peak": own.pop("bar")} if "bar" in own else {}
        history = made_history(scene.time.step, [-0.01] * 4)
        kept += [(scene, made_row(solver, row, scene.name), history) for solver, row in (("dda", own), ("bar", bar))]
    return kept


def core_results(directory):
    """Return the study `core` with all that the first pages speak of, its rows in closed form computed."""
    results = Results(directory)
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
    with pytest.MonkeyPatch.context() as patch:  # curves of fewer points, which take seconds
        patch.setattr(decisions, "POINTS", 60)
        patch.setattr(decisions, "FIRST_POINTS", 50)
        data = core.data()
    kept_study(results, kept, pairs, study="core", derived=derived, data=data)
    gates = [Gate(names[-1], ("dda", "bar"), "pressure.l2", 0, 1, "so", until=until) for until in (0.2, 0.02)]
    results.write_verdicts("core", [judge(gate, gate.until).record("core") for gate in gates])
    return results


# ---- results made by hand -------------------------------------------------------------------------------------------

WORK = {"unknowns": 2, "solves": 7, "steps": 100}
PAIRS = {  # solver and reference -> displacement and pressure, relative L2 [1]
    ("dda", "bar"): (0.0363, 0.0405),
    ("dda", "dda-textbook"): (1.1e-13, 1.2e-11),
    ("fem", "bar"): (2.1e-6, 2.2e-6),
    ("bar", "continuum"): (0.041, 0.042),
    ("dda", "continuum"): (0.051, 0.052),
    ("block-events", "bar-events"): (0.31, 0.32),
    ("dda", "block-events"): (0.21, 0.22),
}
ALARM = {"kind": "hidden tension", "sentence": "it pulls"}


def vibration(scene, solver):
    """Return a damped vibration, each solver's at a frequency of its own; where steps are fine it is dense."""
    time = scene.time.step * np.arange(1, scene.time.steps + 1)
    frequency = {"dda": 344.561, "dda-textbook": 344.561, "continuum": 320.0}.get(solver, 327.682)
    shape = 1 - np.exp(-30 * time) * np.cos(frequency * time)
    return History(time, {"displacement": -0.01 * shape, "contact_pressure": 5e6 * shape})


def made_rows(scene, **more):
    """Return the cases of a scene with rows and histories of its solvers, each number of a size of its own."""
    kept = []
    for number, case in enumerate(scene.expand(), start=1):
        for place, solver in enumerate(case.run.solvers, start=1):
            metrics = {
                "displacement.static": -0.01 - 7e-4 * place, "displacement.settling_step": 44.0 + place,
                "pressure.static": 5e6, "pressure.settling_step": "undefined", "pressure.minimum": -0.338e6 * number,
                "displacement.peak": -0.0123 * number, "mode1.frequency": 327.682 + 16.9 / number * (solver == "dda"),
                "mode1.damping": 0.3 / number, "mode1.measured_damping": "not reported",
            } | more  # fmt: skip
            seconds = {"setup": 1e-3 * place, "stepping": 4e-3 * number * place}
            row = made_row(solver, metrics, case.name, work=WORK, seconds=seconds)
            kept.append((case, row, vibration(case, solver)))
    return kept


def budget(scene):
    """Return a damping budget of constant curves, of which that of the contact ends and the first begins overdamped."""
    dt = np.geomspace(1e-5, 1e-2, 20)
    first = {
        part: [value] * 20
        for part, value in (("total", 0.05), ("algorithmic", 0.012), ("kinetic", 0.015), ("viscous", 0.02))
    }
    first["total"][0] = 1.2
    contact = {part: [0.9] * 15 + [None] * 5 for part in first}
    return {
        "scene": scene, "steps": [1e-3, 2e-3], "gg": 0.98, "gg_rate": None, "dt": dt.tolist(), "floor": 1.0521,
        "modes": {"first axial": first, "contact": contact}, "transit": 3e-4,
    }  # fmt: skip


def first_two(name, **values):
    """Return a built-in scene with the first two values of the key that it sweeps."""
    scene = load_scene(name).with_values(values)
    ((key, swept),) = scene.sweep.items()
    return scene.model_copy(update={"sweep": {key: swept[:2]}})


def made_results(directory):
    """Return three studies, a sweep, two scenes, a contact that opens: each verdict, alarms and a budget."""
    results = Results(directory)
    lost = {"energy.given": 21.0, "energy.lost_switching": 5.01, "energy.lost_friction": 0.0}
    absent = {"mode1.frequency": "undefined", "mode1.damping": "undefined"}
    short = {"time.steps": 61}
    settled = {"displacement.settling_step": 30.0, "pressure.settling_step": 40.0}
    contents = {
        "mine": [made_rows(load_scene("figures-3-4").with_values(short))],
        "two": [made_rows(load_scene("figure-8").with_values(short)), made_rows(first_two("figures-5-6"), **settled)],
        "solo": [made_rows(first_two("unlocked", **short), **lost, **absent)],
    }
    scene, row, _ = contents["solo"][0][0]  # seconds of a run that did not complete are no cost
    contents["solo"][0].append((scene, replace(row, solver="fem", key="lost", outcome=Outcome.OVERFLOW), None))
    verdicts = []
    for study, groups in contents.items():
        kept = [case for group in groups for case in group]
        names = list(dict.fromkeys(scene.name for scene, *_ in kept))
        pairs = []
        for number, name in enumerate(names, start=1):
            for (solver, reference), (v, p) in PAIRS.items():
                pair = between(name, solver, reference, displacement_l2=v * number, pressure_l2=p * number)
                pairs += [pair | {"window": 0.1, "metrics": {}}, pair | {"window": number / 3}]
            bounds = {"displacement.l2": 0.02, "pressure.l2": 0.09}
            if number % 2:
                gates = [
                    Gate(name, ("dda", "bar"), metric, 0.01, high, f"of {name}") for metric, high in bounds.items()
                ]
                verdicts += [judge(gate, 0.0363 * number).record(study) for gate in gates]
        waits = Verdict(
            Gate(names[0], ("dda", "fenicsx"), "pressure.max", 0, 1e-6, "w", "other code", 1e-9),
            None,
            Status.NOT_RUN,
            "no",
        )
        verdicts.append(waits.record(study))
        parts = {
            "provenance": {"commit": study, "system": ["Linux", 6], "changes": [], "with": {"numpy": 2}},
            "alarms": [ALARM | {"scene": name} for name in names],
        }
        budgets = [budget(name) for name in names[:2]] if study == "mine" else []
        kept_study(results, kept, pairs, study=study, title=f"Study {study}", budgets=budgets, **parts)
        results.write_verdicts(study, [verdict for verdict in verdicts if verdict["study"] == study])
    return results


# ---- what a figure shows --------------------------------------------------------------------------------------------


def figure_text(figure):
    """Return what a figure shows, a line for each thing on it, without what depends on fonts or rounding."""
    lines = [f"{_short(25.4 * figure.get_size_inches())} mm"]
    for axes in figure.axes:
        place = (25.4 * np.outer([1, 1], figure.get_size_inches())).ravel() * axes.get_position().bounds
        off = "" if axes.axison else " off"
        lines.append(f"axes{off} at {_short(place)} mm, x {_axis(axes.xaxis)}, y {_axis(axes.yaxis)}")
        lines += [f"  title {text!r}" for text in (axes.get_title(loc="left"), axes.get_title()) if text]
        leaders = [line for line in axes.lines if _kind(axes, line) == "in axes"]  # from a line to its name
        lines += [f"  {len(leaders)} leaders"] * bool(leaders)
        for line in [line for line in axes.lines if line not in leaders]:
            x, y = (np.asarray(values, dtype=float) for values in line.get_data())
            shown = f"{to_hex(line.get_color())} {line.get_linestyle()} {line.get_linewidth():g}"
            dots = f" {line.get_marker()} {line.get_markersize():g} {to_hex(line.get_markerfacecolor())}"
            ends = _short([*x[:1], *x[-1:], *dict.fromkeys([*y[:1], *y[-1:], *_range(y)])])
            between = f" about {_short([_centre(x), _centre(y)])}" * (x.size > 2)
            lines.append(f"  line {shown}{dots * (line.get_marker() != 'None')}: {x.size} at {ends}{between}")
        for patch in axes.patches:
            corners = patch.get_path().vertices
            within = f"{_short(_range(corners))} about {_short(map(_centre, corners.T))}"
            lines.append(f"  patch {to_hex(patch.get_facecolor())}: {len(corners)} within {within}")
        for collection in axes.collections:
            shade = collection.get_array()
            values = [] if shade is None else _range(np.asarray(shade))
            kind = type(collection).__name__.replace("FillBetweenPoly", "Poly")  # its name since matplotlib 3.10
            lines.append(f"  {kind} {_short(values)}, alpha {collection.get_alpha()}")
        for text in axes.texts:
            place = f"{_kind(axes, text)} {_short([*text.get_position(), *getattr(text, 'xy', ())])}"
            lines.append(f"  text {text.get_text()!r} {place} {to_hex(text.get_color())}")
        legend = axes.get_legend()
        lines += [f"  legend {[text.get_text() for text in legend.texts]}"] if legend else []
    return "\n".join(lines)


LOOKS = ("zorder", "alpha", "clip_on", "linewidth", "markeredgewidth", "fontsize", "ha", "va", "rasterized")


def looks(figure):
    """Yield how things are drawn: layers, widths, letters, sides, dashes, and how high titles stand."""
    for axes in figure.axes:
        yield from map(float, (axes.titleOffsetTrans.get_matrix()[1, 2], *axes.yaxis.label.get_position()))
        lines = [line for line in axes.lines if _kind(axes, line) == "data"]
        arrows = [text.arrow_patch for text in axes.texts if getattr(text, "arrow_patch", None)]
        for artist in (*lines, *axes.patches, *axes.collections, *axes.texts, *arrows):
            values = [getattr(artist, f"get_{name}", float)() for name in LOOKS]
            for value in values:
                yield from (part if isinstance(part, str) else float(part or 0.0) for part in np.ravel(value).tolist())
            yield from getattr(artist, "_unscaled_dash_pattern", (0, None))[1] or ()
        yield from (size for arrow in arrows for size in (arrow.shrinkA, arrow.shrinkB))


def _kind(axes, artist):
    return "in axes" if artist.get_transform() == axes.transAxes else "data"


def _axis(axis):
    ticks = axis.get_major_locator()()
    low, high = sorted(axis.get_view_interval())
    inside = [tick for tick in ticks if low <= tick <= high]
    form = axis.get_major_formatter()
    words = [form(tick) for tick in inside] if isinstance(form, FuncFormatter) else list(getattr(form, "seq", ()))
    labels = axis.get_ticklabels()[:: len(words) - 1 or 1] if words else []  # which take long to make
    sides = dict.fromkeys(label.get_horizontalalignment()[0] for label in labels)  # their number is the library's
    between = [tick for tick in axis.get_minor_locator()() if low <= tick <= high]
    minor = f" and {len(between)} between" if between else ""
    hidden = axis.get_tick_params()
    unlabelled = "" if hidden.get("labelleft", hidden.get("labelbottom")) else " unlabelled"
    named = f" as {words} {''.join(sides)}" * bool(words) + unlabelled
    place = axis.label.get_position()[0] if axis.axis_name == "y" else 0
    at = f" at {place:.3g}" if place else ""
    return (
        f"{axis.get_label_text()!r}{at} {axis.get_scale()} {_short((low, high))}, ticks {_short(inside)}{minor}{named}"
    )


def _range(values):
    finite = np.asarray(values, dtype=float)
    finite = finite[np.isfinite(finite)]
    return [float(finite.min()), float(finite.max())] if finite.size else []


def _centre(values):
    """Return a mean in which every value has a weight of its own."""
    finite = np.asarray(values, dtype=float)
    finite = np.clip(finite[np.isfinite(finite)], -1e9, 1e9)
    return np.average(finite, weights=1.3 + np.arange(finite.size)) if finite.size else 0.0


def _short(values):
    # What lies halfway between two numbers of three digits is the greater one on every processor.
    return " ".join(f"{0.0 if abs(value) < 1e-9 else value * (1 + 1e-9):.3g}" for value in values)
