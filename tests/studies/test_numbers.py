"""What the formulas of each study give, in numbers kept in `numbers.toml`: bands of gates, rows, what chapters draw.

Rows are computed here from stand-ins of runs, waves that a name decides, so that nothing is marched: what a row says of
them means nothing, but a sign, a constant or a term of its formula that is another one shows. What tables name is
computed for scenes of odd data, since many numbers of a scene are 1, 2 or alike. That formulas are right is told by the
gates, which are long, and by tests with truths. A number is the sum of w log10(|value| / ROUNDING), w from 1 to 2, with
the sign of the value; one that rounding decides is written as "~". `KEEP_PAGES=1` writes the file anew.
"""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.stand_ins import Numbers, assert_kept, history, numbers_in, share, summed
from oracles.stated_scenes import SCENES, made

from validation.engine.finished import Finished
from validation.runs.case_name import scene_of
from validation.runs.row import Row
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene
from validation.studies.cost.ladder import Ladder
from validation.studies.paper import open_close
from validation.studies.paper.formulas import CLAIMS
from validation.studies.stability import formulas as stability
from validation.suite.claims import Evidence
from validation.suite.folders import get_study, study_folders, study_names
from validation.suite.own_solver import block_data, gates
from validation.suite.own_solver.block import block, first, telling, wrapped
from validation.suite.own_solver.history import AT_REST
from validation.suite.own_solver.session import GateReport
from validation.suite.tables import StudyTable

ROOT = Path(__file__).parents[2]
KEPT = Path(__file__).with_name("numbers.toml")
MOST = 14  # cases of a row
PLAIN = ("time", "sweep", "run", "fem")  # sections that stay as they are


class Histories:
    """Runs that did not take place, as `Results` has their histories."""

    def __init__(self, cases, factor):
        self.cases = cases
        self.factor = factor

    def history(self, key):
        case = self.cases[key]
        return history(case.scene, case.solver, factor=self.factor)


def stand_in(key, case):
    """Return the row of a run that did not take place."""
    numbers = Numbers(case.scene.name, case.solver)
    return Row(key, "", case.scene.name, case.solver, Outcome.COMPLETED, numbers, numbers, numbers, (), 0.01, 9)


def values_in(data):
    """Yield the numbers and words in what a chapter draws."""
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, np.ndarray):
        data = data.tolist()
    if isinstance(data, (list, tuple)):
        for part in data:
            yield from values_in(part)
    elif isinstance(data, (int, float, str)):
        yield data


def odd(case):
    """Return a case with odd numbers in place of all that are not swept; p/E, what topples and what slides stay."""
    values = {}
    for section, keys in case.definition().items():
        if section not in PLAIN and isinstance(keys, dict):
            values |= {f"{section}.{key}": value for key, value in keys.items() if isinstance(value, float) and value}
    kept = {"block.height", "block.young", "load.slope", *case.name.replace("[", ",").replace("=", ",").split(",")}
    values = {key: (1 - 0.1 * share(key, "odd")) * value for key, value in values.items() if key not in kept}
    if side := values.pop("block.side", None):
        values |= {"block.width": 1.1 * side, "block.height": 0.83 * side}
    plane = case.definition().get("plane", {})
    if "glue" not in plane:  # whose blocks are of one kind
        values |= {f"plane.block.{n}.density": 2500.0 - 100 * n for n in range(len(plane.get("block", ())))}
    return case.with_values(values).model_copy(update={"name": case.name})


class OddTable(StudyTable):
    """The table of a study whose cases are of odd data, of each entry the first and the last."""

    def declared_cases(self, entry):
        cases = super().declared_cases(entry)
        return [odd(case) for case in cases[:: max(1, len(cases) - 1)]]


def odd_table(study):
    folder = study_folders()[study.name]
    fields = {key: value for key, value in folder.fields.items() if key not in ("gates", "derived")}
    return OddTable(folder.path, fields, vars(folder.module("formulas")))


def rows_of(study, table, factor=1.0):
    """Return the number of a study's rows, each of the first and the last cases of some scenes."""
    cases = {f"{case.solver} {case.scene.name}": case for case in study.cases()}
    rows = {(case.scene.name, case.solver): stand_in(key, case) for key, case in cases.items()}
    recipes = study.recipes | {(row.scene, row.name): row for row in table.derived()}
    finished = Finished(rows, Histories(cases, factor), recipes)
    first, last = {}, {}
    for scene, name in recipes:
        first.setdefault(name, {}).setdefault(scene_of(scene), scene)
        last.setdefault(name, {})[scene_of(scene)] = scene
    values = []
    with np.errstate(all="ignore"):
        for name in first:
            for scene in [*dict.fromkeys((*first[name].values(), *last[name].values()))][:MOST]:
                metrics = finished.row(scene, name).metrics
                values += [*metrics.values(), 7.0 * len(metrics)]
    return {"computed": summed(values)}


def told_by(gate):
    """Return what a gate says: what it judges, its edges and how wide it is, where more than rounding decides that."""
    width = gate.high - gate.low
    wide = width > 7e-11 * max(abs(gate.low), abs(gate.high))
    numbers = (gate.low, gate.high, 1e9 * width * wide, gate.until, gate.reference_uncertainty)
    return (gate.scene, *gate.pair, gate.metric, gate.reference_kind, *numbers)


def told_by_row(row):
    """Return what a row is of: its name, the cases that it needs and what it reads of them."""
    return (row.scene, row.name, *(part for need in row.needs for part in need), *row.reads)


def numbers(study, table):
    # of 3,400 cases of `stability` those of one scheme: `stability-small` has its formulas
    judged = stability.gates_of(study.scenes[2:3]) if study.name == "stability" else study.gates()
    gates = [part for gate in (*judged, *table.gates()) for part in told_by(gate)]
    generated = [scene.definition() for scene in study.scenes if not isinstance(scene, str)]
    scenes = json.loads(json.dumps(generated).replace(str(ROOT), ""))
    rows = [part for row in study.recipes.values() for part in told_by_row(row)]
    found = {"rows": summed(rows), "gates": summed(gates), "scenes": 1e3 * summed(numbers_in(scenes))}
    found |= {"data": summed(values_in(dict(study.data()))), **rows_of(study, table)}
    return {name: value for name, value in found.items() if value}


@pytest.mark.parametrize("name", study_names())
def test_formulas_give_what_they_gave(name):
    study = get_study(name)
    table = odd_table(study)
    assert_kept(KEPT, name, numbers(study, table), lambda: rows_of(study, table, 1 + 1e-11))


def test_gates_for_users_solvers_are_what_they_were(tmp_path):
    edges = []
    for gate in gates.START.gates():
        edges += [gate.scene, gate.metric, gate.low, gate.high, gate.until or 0.0]
    blocks = [made(name, tmp_path) for name, scene in SCENES.items() if "column" not in scene]
    kinds = summed(kind for scene in blocks for kind in gates.unseen([scene]))
    loaded = [scene for scene in blocks if scene.load.pressure]
    misread = summed(block_data.is_misread(scene, one) for scene in loaded for one in block_data.MISREADINGS)
    assert_kept(KEPT, "own-solver", {"gates": summed(edges), "kinds": kinds, "misread": misread})


TELLING = re.compile(r"\S*\d\S*|(?<=\n)\w+|" + "|".join(gates.GROUPS))  # a sentence may be reworded


def asked():
    """Yield the gates for users' solvers, each with its scene."""
    scenes = {scene.name: scene for scene in gates.START.scenes}
    for gate in gates.START.gates():
        yield gate, scenes[gate.scene]


def report(gate, scene, value, metric, **others):
    """Return what a gate says of a value that a solver gives, but for what else is the case."""
    group = gates.group(gate, scene)
    status = "PASS" if gate.low <= value <= gate.high else "FAIL"
    told = GateReport(
        gate.id, gates.START.name, gate.scene, scene.time.steps, group, metric, status, value, gate.low, gate.high,
        "", "completed", "k", "/nowhere",
    )  # fmt: skip
    return replace(told, **others)


def by_chance(gate, scene, seed):
    """Return what a gate could say of a solver that misreads the block in one way and is wrong elsewhere by chance."""
    at = share(seed, gate.id)
    value = gate.low + 1.7 * (at - 0.3) * (gate.high - gate.low)
    metric = gate.metric
    others = {"steps": (1999, 2000, 2001, 77)[int(10 * at) % 4], "apart": 0.3 * at}
    if metric == "displacement.static":
        metric = AT_REST
        value = block_data.misread_displacement(scene, block_data.MISREADINGS[int(seed) % 9])
    elif gates.group(gate, scene) != gates.BLOCK_DATA:
        others["group"] = list(gates.GROUPS)[int(40 * at) % len(gates.GROUPS)]
    if share(gate.id, seed) < 0.2:
        others["status"] = ("NOT RUN", "FAIL")[int(100 * at) % 2]
        others["outcome"] = ("", "raised", "not a number")[int(1e3 * at) % 3]
        others["why"] = f"E: step {seed} (f.py:7)"
    if at > 0.9:
        others["same_as"] = "dda-60 dda"
    if at < 0.07:
        others["apart_in"] = "x"
    return report(gate, scene, value, metric, **others)


def test_blocks_tell_what_they_told():
    told = []
    for seed in map(str, range(27)):
        reports = [by_chance(gate, scene, seed) for gate, scene in asked()]
        failed = [report for report in reports if report.status == "FAIL"]
        groups = first(reports, failed)
        most = telling(failed, groups)
        lines = block(reports, seed < "2")
        told += [len(lines), *groups, most.scene if most else "none", *TELLING.findall(" ".join(lines))]
    assert_kept(KEPT, "blocks", {"told": summed(told)})


def answered(scale):
    """Return what the gates for users' solvers say where some values are so many times the middles of their bands."""
    reports = []
    for gate, scene in asked():
        metric = AT_REST if gate.metric == "displacement.static" else gate.metric
        reports.append(report(gate, scene, scale(scene, metric) * (gate.low + gate.high) / 2, metric))
    return reports


def test_what_is_told_of_a_users_solver_is_what_was_told():
    rectangle, *others = block_data.scenes()
    first = gates.starts()[1]
    wrong = {  # places that are no place of a misreading, and motions
        "elsewhere": {(rectangle.name, AT_REST): 1.37, (others[2].name, AT_REST): 0.7},
        "moving": {(rectangle.name, "displacement.max"): 3.0},
        "pressure": {(first.name, "pressure.max"): 3.0},
        "both": {(first.name, "pressure.max"): 3.0, (first.name, "mode1.frequency"): 1.2},
        "all": dict.fromkeys([(first.name, one) for one in ("displacement.max", "mode1.measured_damping")], 5.0),
    }
    told = {name: answered(lambda s, metric, w=w: w.get((s.name, metric), 1.0)) for name, w in wrong.items()}
    for number, misreading in enumerate(block_data.MISREADINGS):

        def scale(scene, metric, misreading=misreading):
            if metric != AT_REST:
                return 1.0
            rest = block_data.displacement_at_rest(scene)
            return block_data.misread_displacement(scene, misreading) / rest

        told[f"misread {number}"] = answered(scale)
    statics = replace(told["misread 0"][0], status="FAIL", group="statics", value=-0.0371, low=0.01, high=0.02)
    told["statics"] = [*told["misread 0"], statics]
    told["following"] = [*told["misread 0"], replace(statics, scene=rectangle.name)]
    told["warned"] = [
        *(replace(one, same_as="bar dda") for one in told["both"][:3]),
        replace(told["both"][3], same_as="dda", apart_in="displacement", apart=0.0371),
        *told["all"],
    ]
    blocks = {name: block(reports, every=name == "all") for name, reports in told.items()}
    assert_kept(KEPT, "told", {name: summed(wrapped(lines)) for name, lines in blocks.items()})


class Settling(Evidence):
    """Evidence of histories that come to rest about their static values, some in ten steps, some in a hundred."""

    def number(self, case, metric, solver="dda"):
        return Numbers(case, solver, self.finished)[metric]

    def scaled(self, case, quantity):
        steps = np.arange(1, 250)
        return 1 + 0.9 * (-0.85 - 0.12 * share(case, quantity, self.finished)) ** steps


def test_claims_measure_what_they_measured():
    told = []
    for claim in CLAIMS:
        if claim.id not in open_close.TESTS:  # which read histories by other names
            every = [claim.measure(Settling(name)) for name in "abc"]
            for measured in every:
                told += [*measured, *measured.values(), claim.finding(measured)]
    assert_kept(KEPT, "claims", {"measured": summed(told)})


ODD = {"block.poisson": 0.2, "block.subdivide": [2, 3], "fem.elements": 7, "contact.stiffness": 3e8}


def test_other_blocks_are_solved_in_the_scenes_that_they_were():
    odd = Ladder.of(load_scene("cost-paper").with_values(ODD))
    others = [("cost-paper", {"load.ramp": 0.01}), ("cost-opening", {"block.poisson": 0.25}), ("cost-opening", {})]
    ladders = [odd, *(Ladder.of(load_scene(name).with_values(values)) for name, values in others)]
    references = [ladder.scene(ladder.reference).definition() for ladder in ladders]
    found = {"odd": 1e3 * summed(numbers_in([scene.definition() for scene in odd.scenes()]))}
    data = [scene.definition() for scene in gates.START.scenes]
    assert_kept(
        KEPT, "others", found | {"references": summed(numbers_in(references)), "data": summed(numbers_in(data))}
    )
