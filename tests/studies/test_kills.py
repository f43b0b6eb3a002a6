"""Kill matrices of studies: every gate is bitten by a seeded fault, and every fault is seen by a gate."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.linalg
from conftest import beside
from faults.fault import of_first, told
from faults.fault_table import faults_of
from faults.kill_matrix import check_study

import dda
from dda.bodies import turning_step as step
from dda.bodies.gap_form import ModalForm
from dda.bodies.turning_body import turned
from dda.march.step import steps_by
from validation.engine.run import run_study
from validation.gates.gate import Status
from validation.report.book import build, write_figures
from validation.studies.rebound import formulas as rebound
from validation.suite.folders import get_study

# ---- columns ---------------------------------------------------------------------------------------------------------


def wrong_sign(sound):
    """Let every contact open where the block below it rises."""

    def faulty(*given):
        body = sound(*given)
        weight = body.weight.copy()
        weight[1:, :2] *= -1
        return body._replace(weight=weight)

    return faulty


def heavier(part, factor):
    """Multiply the density of blocks or bars."""
    return of_first(lambda p: {part: tuple(replace(one, density=factor * one.density) for one in getattr(p, part))})


def stronger(factor):
    """Multiply the strength of joints."""
    return of_first(
        lambda p: {"joints": tuple(one and replace(one, strength=factor * one.strength) for one in p.joints)}
    )


one_late = told(lambda result: {"columns": {name: np.append(0.0, x[:-1]) for name, x in result.columns.items()}})

# ---- waves -----------------------------------------------------------------------------------------------------------


def stiffer(factor):
    """Multiply the stiffness of springs."""

    def wrap(sound):
        return lambda column: [replace(spring, stiffness=factor * spring.stiffness) for spring in sound(column)]

    return wrap


def deeper(sound):
    """Take a layer's depth one per cent too large."""
    return lambda modulus, density, depth, w2, state: sound(modulus, density, 1.01 * depth, w2, state)


# ---- sub-blocks ------------------------------------------------------------------------------------------------------


def soft_glue(sound):
    """Glue with half the stiffness."""
    return lambda model, columns, rows, glue, pattern: sound(model, columns, rows, glue / 2, pattern)


# ---- stability, stiff contact, limits --------------------------------------------------------------------------------


def printed_recursion(sound):
    """Swap the robust form for the textbook one."""
    return lambda model, scheme, steps, columns, *rest: dda.solve_textbook(model, scheme, steps, columns)


def robust_form(sound):
    """Swap the textbook form for the robust one."""
    return lambda model, scheme, steps, columns: dda.solve(model, scheme, steps, columns)


def unscaled_modes(sound):
    """Find the modes by a general solver, which scales nothing."""

    def faulty(form):
        squares, shapes = scipy.linalg.eigh(np.diag(form.K), form.M)
        return ModalForm(np.sqrt(np.abs(squares)), shapes, shapes.T @ form.F, shapes.T @ form.M @ form.R)

    return faulty


def offset(sound):
    def faulty(observed, pressure):
        observed += 1e-6
        return ()

    return faulty


def of_degree(degree):
    """Build every mesh of one degree."""
    return lambda sound: lambda mesh, asked: sound(mesh, degree)


# ---- blocks that move in the plane -----------------------------------------------------------------------------------


def with_springs(**changes):
    """Change what the springs of contacts have, stated or found, by functions or by factors."""

    def other(law):
        if law is None:
            return None
        if not isinstance(law, dda.ContactSprings):  # of each pair of blocks its own
            return lambda first, second: other(law(first, second))
        values = {name: change(getattr(law, name)) if callable(change) else change * (getattr(law, name) or 0.0)
                  for name, change in changes.items()}  # fmt: skip
        return replace(law, **values)

    def change(model):
        contacts = [replace(contact, springs=other(contact.springs)) for contact in model.contacts]
        return {"contacts": contacts, "found": other(model.found)}

    return of_first(change)


def of_blocks(change):
    """Change fields of every block."""
    return of_first(lambda model: {"blocks": [replace(block, **change(block)) for block in model.blocks]})


def with_blocks(**factors):
    """Multiply what blocks have."""
    return of_blocks(lambda block: {name: factor * np.array(getattr(block, name)) for name, factor in factors.items()})


def with_bonds(factor):
    """Multiply the normal springs of glue."""
    return of_first(lambda model: {"bonds": [replace(bond, stiffness=factor * bond.stiffness) for bond in model.bonds]})


def with_weight(factor=1.0, turned=0.0):
    """Multiply the acceleration and all loads, and turn them [deg]."""
    angle = np.radians(turned)
    turn = factor * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def change(model):
        loads = [replace(load, force=tuple(turn @ load.force)) for load in model.loads]
        return {"loads": loads, "gravity": tuple(turn @ model.gravity)}

    return of_first(change)


def accounted(**changes):
    """Change energies of a result, each a function of all of them."""
    return told(lambda result: {"energy": result.energy | {name: f(result.energy) for name, f in changes.items()}})


def without(value):
    """Leave out a law: what has none sticks."""
    return None


unaccounted = accounted(balance=lambda energy: 1e-9 * energy["kinetic"])
in_no_account = accounted(balance=lambda energy: energy["balance"] + 1e-6 * energy["load"])
rising = accounted(
    kinetic=lambda energy: (1 + 1e-9 * np.arange(len(energy["kinetic"]))) * energy["kinetic"],
    balance=lambda energy: energy["balance"] + 1e-9 * energy["kinetic"],
)
spinning = of_blocks(lambda block: {} if block.fixed else {"spin": 1.1 * block.spin + 0.02})


def outlines(size):
    """Multiply the corners of the blocks that move about their centroids."""

    def change(block):
        centroid = block.block.section.centroid
        return {} if block.fixed else {"vertices": centroid + np.array(size) * (block.block.corners - centroid)}

    return of_blocks(change)


# ---- contact that opens: one block or bar ----------------------------------------------------------------------------


def pressed(found):
    """Return a history with 1e-3 Pa more on the contact."""
    return replace(found, contact_pressure=found.contact_pressure + 1e-3)


def carrying(sound):
    """Return a motion whose contact is pressed a little, where it is open as well."""

    def solve(problem, end, **options):
        motion = sound(problem, end, **options)
        names = ("switches", "touches", "simultaneous", "radius", "bars", "impacts", "cascades", "problem")
        known = {name: getattr(motion, name) for name in names if hasattr(motion, name)}
        return SimpleNamespace(at=lambda t: pressed(motion.at(t)), **known)

    return solve


def off_in_the_middle(sound):
    """Return closed forms of which that of the mid-height is off."""

    def forms(x2):
        own, across, middle = sound(x2)
        return own, across, (1 + 1e-6) * middle

    return forms


def fewer(sound):
    """Lose the last switch."""

    def solve(*a, **k):
        motion = sound(*a, **k)
        return replace(motion, switches=motion.switches[:-1])

    return solve


def faster(velocity):
    """Return a velocity whose rebound is a millionth too fast."""
    return velocity + 1e-6 * np.maximum(velocity, 0.0)


# ---- glued blocks ----------------------------------------------------------------------------------------------------


def traction_times(factor):
    """Multiply the two components of a traction."""
    return lambda sound: lambda *a: tuple(factor * part for part in sound(*a))


def without_half_of_the_shear(sound):
    """Lose the half of g_xy in the displacement of a point: x then takes none of it, and y all."""

    def rows(*a):
        values = np.array(sound(*a))
        if values.shape[1] == 6:
            values[:, 5] = [0.0, 2 * values[1, 5]]
        return values

    return rows


def in_plane_strain(sound):
    return lambda *a, **k: replace(sound(*a, **k), hypothesis="plane strain")


def harder(by):
    """Multiply Young's modulus of the blocks."""
    return lambda sound: lambda *a, **k: replace(sound(*a, **k), young=by * sound(*a, **k).young)


def glued_by(factor):
    """Multiply the springs across every shared edge."""
    return lambda sound: lambda blocks, normal, shear: sound(blocks, factor * normal, shear)


def pulled(factor):
    """Multiply all tractions."""
    return lambda sound: lambda start, end, value: sound(start, end, (factor * value[0], factor * value[1]))


# ---- blocks that turn ------------------------------------------------------------------------------------------------


def read_as(change):
    """Return a wrapper that changes what a property tells."""
    return lambda sound: property(lambda model: change(sound.__get__(model)))


lighter = read_as(lambda weight: 0.99 * weight)
steeper = read_as(lambda weight: turned(math.radians(0.5)) @ weight)


def at_the_end(sound):
    """Take forces at the end of the step."""
    return lambda delta: 1.0


def heavy(sound):
    def faulty(M, block):
        heavier = M.copy()
        heavier[2, 2] *= 1.02
        return sound(heavier, block)

    return faulty


def quicker(share):
    """Add a share to the velocities in every step."""

    def wrap(sound):
        def faulty(march, stage, start, before, after, *given):
            outcome, solves = step.make_stage(march, stage, start, before, after, *given)
            after.p[:] = [(1 + share) * p for p in after.p]
            return outcome, solves

        return steps_by(faulty, step.account, step.keep)

    return wrap


def turning_by(is_exact):
    return lambda sound: lambda Q, r, exact, out: sound(Q, r, is_exact, out)


def grown_twice(sound):
    def faulty(Q, r, exact, out):
        sound(Q, r, exact, out)
        if not exact:
            out.end[:] = [[math.sqrt(1 + r * r) * x for x in row] for row in out.end]

    return faulty


def further(share):
    """Return a wrapper that makes the base move further by a share."""
    return lambda sound: (
        lambda model: (motion := sound(model)) and replace(motion, displacement=(1 + share) * motion.displacement)
    )


def doubled(sound):
    def faulty(*given):
        columns = sound(*given)
        return columns | {"rotation": 2 * columns["rotation"]}

    return faulty


NAMES = (
    *("meeting", "spin", "pushing", "boxes", "standing", "touching", "patch", "beams", "plates", "rocking", "toppling"),
    *("impacts", "opening", "rebound", "columns", "waves", "subblocks", "stability-small", "stiff-contact", "limits"),
    "core",
)
LEFT_OUT = {  # words of scenes or solvers whose gates stand elsewhere
    "waves": ("waves-facts",),  # without runs, in test_facts.py
    "rebound": (rebound.MAP,),  # and in test_rebound.py
    "touching": ("query",),  # which no run of a solver changes: in test_touching.py
    **dict.fromkeys(("patch", "beams", "plates"), ("fenicsx",)),
    # Larger systems take seconds a fault: their gates measure what those of the smaller ones measure.
    "subblocks": (
        *("subblocks-locking", "16x16", "1x16", "1x32", "5x5", "=4x4,fem"),
        *("8x8", "=100,", "=10]", "width=0.6", "width=0.2"),
    ),
}
FIRST = {  # faults that bite gates of scenes whose runs take seconds, tried before others
    "plates-disc": ("PLANE_MATERIAL harder [1.2]", "TRACTION pulled [1.2]"),
    "plates-glue": ("PLANE_MATERIAL harder [1.01]",),
    "plates-hole": ("PLANE_MATERIAL harder [1.2]", "TRACTION pulled [1.2]"),
}
SHORT = ("columns-domino", "columns-settle[time.step=0.02", "columns-slips-steps[time.step=0.005")


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_every_gate_is_bitten_and_every_fault_is_seen(name, tmp_path, finished_cases):
    def is_checked(gate):
        return not any(word in part for word in LEFT_OUT.get(name, ()) for part in (gate.scene, *gate.pair))

    check_study(name, faults_of(name, globals()), tmp_path, finished_cases, is_checked, FIRST)


def test_gates_of_some_columns_are_bitten(tmp_path, finished_cases):
    faults = faults_of("columns", globals())[:3]
    alone = ["columns"]
    check_study("columns", faults, tmp_path, finished_cases, lambda gate: gate.scene.startswith(SHORT), judged=alone)


@pytest.mark.long
@pytest.mark.parametrize("name", ("stability-small", "stiff-contact", "limits"))
def test_every_gate_passes_and_the_chapter_is_written(name, tmp_path, finished_cases):
    results = beside(finished_cases, tmp_path / "results")
    assert {verdict.status for verdict in run_study(get_study(name), results)} == {Status.PASS}
    assert build(results, tmp_path / "report.pdf").stat().st_size > 20_000
    assert all(path.exists() for path in write_figures(results, tmp_path / "figures", [name]))
