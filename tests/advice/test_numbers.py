"""What advice is known without a run, as numbers kept in `numbers.toml` beside this file; `KEEP_PAGES=1` renews it."""

import itertools
import re
import tomllib
from collections.abc import Iterator
from itertools import cycle
from pathlib import Path

import pytest
from oracles.made_cases import made_row
from oracles.pages import NUMBER
from oracles.stand_ins import Numbers, assert_kept, numbers_in, share, summed

from validation import advise, advise_across, damping, load_scene
from validation.advice import across, budget, columns, contact, contact_page, friction, goals, overview, spectra
from validation.advice.coarse import coarse_alarms
from validation.advice.draft import KINDS, ROCKS, draft
from validation.advice.hooks import AdviceHooks
from validation.advice.plain import in_rows
from validation.advice.wave_advice import advise_wave
from validation.theory.stepping import Stepping

KEPT = Path(__file__).with_name("numbers.toml")
PAPER = load_scene("figures-3-4").with_values({"time.step": 0.002, "load.gravity": 9.81})
BLOCKS = {
    "plain": {},
    "discount": {"time.gg": 0.97, "time.alpha": 0.36, "time.delta": 0.7},
    "rate": {"time.gg_rate": 30.0, "time.alpha": 0.25, "time.delta": 0.5, "block.poisson": 0.2},
    "lost": {"time.gg": 0.0},
    "scheme": {"time.scheme": "chung-hulbert", "time.rho_inf": 0.4},
    "explicit": {"time.scheme": "leapfrog", "time.start": "consistent", "time.step": 5e-4},
    "opens": {"contact.law": "unilateral", "block.velocity": -0.7, "contact.gap": 0.01},
}
COLUMNS = {
    "site": ("waves-site", {"time.allow_unstable": True}),
    "joint": ("waves-joint", {"time.allow_unstable": True}),
    "undamped": ("waves-joint", {"time.alpha": 0.25, "time.delta": 0.5, "time.gg": 0.99}),
    "shaken": ("columns-shaken", {}),
    "stack": ("field-stack", {"column.gravity": 9.81, "time.gg": 0.99}),
    "slips": ("columns-slips", {"time.alpha": 0.25, "time.delta": 0.5}),
    "explicit": ("field-cradle", {"time.alpha": 0.0, "time.delta": 0.5}),
    "cradle": ("field-cradle", {"time.alpha": 0.25, "time.delta": 0.5, "column.gravity": 9.81}),
}
STEPPINGS = (
    *(Stepping(0.002, 0.25, 0.5), Stepping(0.003, 0.3, 0.6, 0.95), Stepping(0.01, 0.25, 0.5, 0.8)),
    *(Stepping(0.002, 0.5, 1.0), Stepping.named("chung-hulbert", 0.02, rho_inf=0.3)),
)
TARGETS = ((0.02, "dt"), (0.3, "gg"), (0.1, "scheme"), (1.9, "dt"))
SYMBOLS = re.compile(r"\b(?:dt|gg|delta|alpha)\b")
SLOPES = {"slope-drag": {}, "creep-steps": {}, "slope-sliding": {}, "slope-threshold": {"time.gg": 0.0}}
PAGES = (  # scene, values, penetration
    ("unlocked-constant", {"time.step": 1e-3, "contact.stiffness": 1e11, "time.gg": 0.97, "contact.gap": 0.3}),
    ("unlocked-average", {"time.step": 1e-3, "block.velocity": -2.0, "contact.band": [0.0, 1e-4]}, 3e-4),
    ("slope-drag", {"contact.stiffness": 1e9}),
    ("slope-drag", {"load.slope": 10.0, "time.gg": 1.0}, 2e-5),
    ("columns-weight", {"time.gg": 0.9}),
    ("columns-slips", {}),
)


FALLS = {"contact.law": "unilateral", "contact.gap": 0.01, "block.velocity": -0.7}
OTHER = {"time.alpha": 0.36, "time.delta": 0.7}
RUNS = {  # scenes whose runs are made
    "locked": ("figures-3-4", {}),
    "opens": ("figures-3-4", FALLS | {"time.step": 0.02, "time.gg": 0.97, "contact.band": [0.0, 1e-4]}),
    "average": ("figures-3-4", FALLS | {"time.alpha": 0.25, "time.delta": 0.5, "contact.stiffness": 1e11}),
    "unloaded": ("figures-3-4", FALLS | {"load.pressure": 0.0, "time.gg": 0.0, "contact.band": [0.0, 1e-7]}),
    "other": (
        "figures-3-4",
        FALLS | {"time.alpha": 0.3, "time.delta": 0.6, "contact.stiffness": "inf", "contact.shear_stiffness": 0.0},
    ),
    "creeps": ("creep-steps", {"contact.rules": "lagged", "time.steps": 4000}),
    "slides": ("slope-drag", {}),
    "stands": ("creep-steps", {"time.step": 1e-5, "time.gg": 0.99}),
    "stack": ("field-stack", {"column.gravity": 9.81}),
}
GRANITE = {"block.side": 1.2, "block.young": 5e10, "block.poisson": 0.25, "contact.stiffness": 5e11}
FACTS = (
    {"time.gg": 0.97, "time.delta": 0.7},
    {"block.subdivide": [1, 5], "time.alpha": 0.25, "time.delta": 0.5, "contact.stiffness": 1e11},
    FALLS | {"contact.stiffness": 3e8},
)
MEASURED = (
    *("contact.gap", "contact.least_root", "contact.open_share", "contact.peak_force", "contact.slip_rate"),
    *("contact.spectral_radius", "energy.given", "energy.lost_algorithmic", "energy.lost_switching"),
    *("energy.switching_gain", "mode1.frequency", "pressure.minimum", "pressure.minimum_time"),
    *("pressure.tension_time", "switches.count", "switches.first_closing"),
)


def first_of(name):
    return load_scene(name).expand()[0]


def alarms_of(scene):
    """Yield what is warned of before a run, in numbers."""
    for alarm in (*coarse_alarms(scene, 20.0), *AdviceHooks.of(scene).alarms(scene)):
        yield alarm.kind, dict(alarm.values)


def of_block(scene):
    """Yield what is known of a block on its springs."""
    yield [*alarms_of(scene)]
    if scene.contact.law == "locked":
        yield damping(scene).as_dict()
        for target, solve_for in TARGETS if scene.time.scheme == "newmark" else ():
            advice = advise(scene, damping=target, solve_for=solve_for)
            yield advice.as_dict(), SYMBOLS.findall(advice.sentence)
    if scene.time.scheme == "newmark":
        landing = contact.restitution(scene)
        yield contact.omega(scene), landing and [landing.low, landing.mean, landing.high, landing.own]
        yield [*contact.needed(scene, 0.7, 1e-4)], [*contact.needed(scene, 0.0, 1e-4, lambda p: 1e5 / p)]


def of_column(scene):
    """Yield what is known of a column, and of its wave."""
    yield [*alarms_of(scene)]
    if scene.column.law == "bonded":
        yield advise_wave(scene, 12.0, 0.1).as_dict(), advise_wave(scene, 40.0, 1e-3, 20.0).as_dict()
        yield advise_wave(scene, 12.0, 0.99, 0.1, 0.9).as_dict()
    else:
        known = columns.limits(scene)
        yield vars(known)
        for resting in (None, columns.Rest(0.3, 0.9, 2e-3), columns.Rest(None, 0.9, 2e-3)):
            yield [*columns.advised(scene, known, resting)]
        yield columns._at_rest(scene.column)


def of_runs(scene):
    """Yield what is warned of after runs that are made."""
    for number in range(5):
        rows = {}
        for solver in ("dda", "fem", "bar-events"):
            metrics = {name: 4 * share(str(number), solver, name) - 1.3 for name in MEASURED}
            rows[solver] = made_row(solver, metrics, scene.name)
        for alarm in AdviceHooks.of(scene).alarms(scene, rows):
            yield alarm.kind, dict(alarm.values), alarm.sentence


def of_lines():
    """Yield rows of columns whose last one is wrapped beside the others, or below its line."""
    lines = [("goal", "steps", "what it is for, in words that go on and on"), ("impact", "7", "a landing"), ()]
    for width, indent, right in itertools.product((None, *range(20, 60), 200), ("", "   "), ((), (1,))):
        yield in_rows(lines, width, indent, right)
    yield in_rows([()], 30), in_rows([("of one column, which is wrapped where there is no room",)] * 2, 40)


def of_schemes(scene):
    """Yield which schemes damp a scene, and what is known of some."""
    modes = spectra.dda_modes(scene)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(across, "LADDER", {"wbz": (0.5,)})
        patch.setattr(across, "IMPACTS", (1.5, 1e5))
        for stepping in STEPPINGS:
            offer = across._offer(scene, 100.0, modes, 5 * modes[0].frequency, 3e3, stepping)
            yield vars(offer)
        late = FALLS | {"time.start": "consistent"}
        cases = (({"time.gg": 0.98}, None, 0.07), (late, None, 0.03), (FALLS, False, 0.07), (OTHER, None, 0.6))
        for values, no_gain, target in cases:
            yield advise_across(scene.with_values(values), target, no_gain=no_gain).as_dict()


def of_coarse(granite):
    """Yield what is told of a step that is too long, without a run."""
    opens = {"contact.law": "unilateral"}
    rigid = opens | {"contact.stiffness": "inf", "contact.shear_stiffness": 0.0}
    damped = {"time.scheme": "chung-hulbert", "time.rho_inf": 0.0}
    average = {"time.alpha": 0.25, "time.delta": 0.5}
    slides = opens | {"contact.friction": 30.0, "load.pressure": 0.0, "load.slope": 20.0}
    cases = ({}, {"block.subdivide": [2, 2]}, opens, rigid, damped, average, slides, {"time.gg": 0.0})
    scenes = [
        granite.with_values({"time.step": step} | values)
        for step, values in itertools.product((1e-3, 3e-4, 1.2e-5), cases)
    ]
    column = first_of("waves-base")
    for step, frequency in ((1e-3, 2.0), (5e-3, 2.0), (0.05, 2.0), (1e-3, 100.0)):
        scenes.append(column.with_values({"time.step": step, "input.frequency": frequency}))
    for scene in (*scenes, granite.with_values({"load.ramp": 0.1})):
        yield [[alarm.kind, dict(alarm.values), alarm.sentence] for alarm in coarse_alarms(scene)]


def typed(kind, rock, question):
    """Return the scene that `new` writes of answers that are a little larger than what is offered."""
    return tomllib.loads(draft({"kind": kind, "rock": rock}, lambda name, value: round(question * value, 3)))


def of_contact_page(scene, *penetration):
    """Yield what the page of contact says of rows that are made."""
    bound = AdviceHooks.of(scene).contact_limits(scene)
    lines = [line for kind in contact_page.LINES.values() for line in kind if "metric" in line]
    measured = ["switches.first_opening", "switches.first_closing", "energy.given", *(line["metric"] for line in lines)]
    rows = {}
    for name, case in contact_page.scenes(scene, bound).items():
        yield case.time.discount
        made = Numbers(name, scene.name)
        rows[name] = made_row(name, {metric: made[metric] for metric in ", ".join(measured).split(", ")}, scene.name)
    data = contact_page.answer(scene, rows, *penetration, bound=bound)
    lines = list(contact_page.page(scene, data, {}, bound))
    yield data, lines
    some = {name: {metric: x for metric, x in run.items() if share(metric) < 0.5} for name, run in data["runs"].items()}
    yield contact_page.table(scene, some, "contact of a block" if bound is None else "contacts of a column")


def of_goal(scene, goal, **changes):
    """Yield what is recommended for a goal, searched on a coarse mesh with long steps."""
    with pytest.MonkeyPatch.context() as patch:
        for name, value in changes.items():
            patch.setattr(goals, name, value)
        patch.setattr(goals, "estimated_seconds", lambda *given: 1.0)
        for offer in goals.recommend(scene, goal, goals.Question(error=0.2, frequency=30.0)):
            yield vars(offer)


def numbers_of_advice(step=0.002):
    block = PAPER.with_values({"time.step": step})
    found = {f"block {name}": of_block(block.with_values(values)) for name, values in BLOCKS.items()}
    for name, (scene, values) in COLUMNS.items():
        found[f"column {name}"] = of_column(first_of(scene).with_values(values))
    for name, values in SLOPES.items():
        scene = first_of(name).with_values(values)
        found[f"slope {name}"] = (friction.sliding(scene).as_dict(), [*alarms_of(scene)])
    for kind, rock in zip(KINDS, cycle(ROCKS), strict=False):
        found[f"new {kind}"] = typed(kind, rock, 1.1)
    for number, (name, values, *penetration) in enumerate(PAGES):
        found[f"page {number}"] = of_contact_page(first_of(name).with_values(values), *penetration)
    for name, (scene, values) in RUNS.items():
        found[f"runs {name}"] = of_runs(first_of(scene).with_values({"time.step": step} | values))
    slope = first_of("slope-drag").with_values({"fem.elements": 2})
    coarse = block.with_values({"fem.elements": 2})
    of_facts = [overview._facts(scene) for scene in (*map(coarse.with_values, FACTS), slope)]
    found["facts"] = [[fact.subject, fact.part, fact.sentence] for facts in of_facts for fact in facts]
    found["coarse"] = of_coarse(PAPER.with_values(GRANITE))
    levels = itertools.product((0.01, 1.0, 1.3), (0.0, 0.7, 1.0, 1.2))
    found["levels"] = [spectra.steps_to(*both) for both in levels]
    found["lines"] = [summed(numbers_in([*of_lines()]))]
    found["across"] = of_schemes(block)
    found["goal quake"] = of_goal(block, "quake", ELEMENTS=2, REFINEMENTS=2, COARSEST=12)
    found["goal slide"] = of_goal(first_of("slope-drag"), "static", FINEST_SLIDE=16, FEWEST_SLIDE=2)
    damped = {"damping.mass": 3.0, "damping.stiffness": 2e-5}
    ends = [{"time.step": step} for step in (4e-7, 0.4)]
    found["budgets"] = budget.budgets([block.with_values(values) for values in (*ends, BLOCKS["discount"], damped)])
    texts = {}
    return {name: summed(numbers_in(plain(value, texts))) for name, value in found.items()}


def plain(value, texts):
    """Return data with the numbers of each sentence, and which of all it is, in its place."""
    if isinstance(value, str) and " " in value:
        return [texts.setdefault(NUMBER.sub("", value), len(texts)), [float(text) for text in NUMBER.findall(value)]]
    if isinstance(value, dict):
        return {key: plain(part, texts) for key, part in value.items()}
    if isinstance(value, list | tuple | Iterator):
        return [plain(part, texts) for part in value]
    return value


def test_advice_is_as_before():
    assert_kept(KEPT, "advice", numbers_of_advice(), lambda: numbers_of_advice(0.002 * (1 + 1e-11)))
