"""Kill matrices of studies: every gate is bitten by a seeded fault, and every fault is seen by a gate."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.linalg
from conftest import beside
from faults import seams
from faults.fault import (
    Fault,
    energy_changed,
    late,
    no_damping,
    no_discount,
    of_first,
    scaled,
    thousandth,
    times,
    told,
    with_scheme,
)
from faults.kill_matrix import check_study

import dda
from dda.bodies import turning_step as step
from dda.bodies.gap_form import ModalForm
from dda.bodies.turning_body import EXACT, FIRST_ORDER, turned
from dda.march.step import steps_by
from validation.engine.run import run_study
from validation.gates.gate import Status
from validation.report.book import build, write_figures
from validation.studies.rebound import formulas as rebound
from validation.suite.folders import get_study

# ---- columns ---------------------------------------------------------------------------------------------------------

DDA, EVENTS, BARS = ("dda",), ("column-events",), ("bars-events",)


def wrong_sign(sound):
    """Let every contact open where the block below it rises."""

    def faulty(*given):
        body = sound(*given)
        weight = body.weight.copy()
        weight[1:, :2] *= -1
        return body._replace(weight=weight)

    return faulty


def larger(factor):
    """Multiply what a column's history holds."""
    return told(lambda result: {"columns": {name: factor * x for name, x in result.columns.items()}})


def heavier(part, factor):
    """Multiply the density of blocks or bars."""
    return of_first(lambda p: {part: tuple(replace(one, density=factor * one.density) for one in getattr(p, part))})


def stronger(factor):
    """Multiply the strength of joints."""
    return of_first(
        lambda p: {"joints": tuple(one and replace(one, strength=factor * one.strength) for one in p.joints)}
    )


COLUMNS = [
    Fault("blocks: coupling of the wrong sign", DDA, seams.CONTACT_BODY, wrong_sign),
    Fault("blocks: every solve counted twenty times", DDA, seams.CONTACT_COLUMN,
          told(lambda result: {"step_solves": 20 * result.step_solves})),
    Fault("blocks: histories 2 % high", DDA, seams.CONTACT_COLUMN, larger(1.02)),
    Fault("blocks: delta 10 % high", DDA, seams.CONTACT_COLUMN, with_scheme(1, delta=lambda delta: 1.1 * delta)),
    Fault("exact columns: blocks 1e-7 heavy", EVENTS, seams.EVENTS_COLUMN, heavier("blocks", 1 + 1e-7)),
    Fault("exact columns: blocks 2 % heavy", EVENTS, seams.EVENTS_COLUMN, heavier("blocks", 1.02)),
    Fault("exact bars: 1e-6 heavy", BARS, seams.EVENTS_BARS, heavier("bars", 1 + 1e-6)),
    Fault("exact bars: joints 5 % strong", BARS, seams.EVENTS_BARS, stronger(1.05)),
]  # fmt: skip

# ---- waves -----------------------------------------------------------------------------------------------------------


def stiffer(factor):
    """Multiply the stiffness of springs."""

    def wrap(sound):
        return lambda column: [replace(spring, stiffness=factor * spring.stiffness) for spring in sound(column)]

    return wrap


def deeper(sound):
    """Take a layer's depth one per cent too large."""
    return lambda modulus, density, depth, w2, state: sound(modulus, density, 1.01 * depth, w2, state)


WAVES = [
    Fault("blocks: inertia 1e-7 heavy", DDA, seams.COLUMN_INERTIA, times(1 + 1e-7)),
    Fault("blocks: stiffness 1e-7 high", DDA, seams.COLUMN_STIFFNESS, times(1 + 1e-7)),
    Fault("springs: 1e-6 stiff", DDA, seams.COLUMN_SPRINGS, stiffer(1 + 1e-6)),
    Fault("springs: 0.1 % soft", DDA, seams.COLUMN_SPRINGS, stiffer(0.999)),
    Fault("base: dashpot 1e-7 strong", DDA, seams.COLUMN_BASE, times(1 + 1e-7)),
    Fault("steps: 2 % high", DDA, seams.CONTACT_COLUMN, larger(1.02)),
    Fault("steps: delta 0.1 % high", DDA, seams.COLUMN_VELOCITY, with_scheme(0, delta=thousandth)),
    Fault("steps: one late", DDA, seams.CONTACT_COLUMN,
          told(lambda result: {"columns": {name: np.append(0.0, x[:-1]) for name, x in result.columns.items()}})),
    Fault("steps: no discount", DDA, seams.CONTACT_COLUMN, no_discount(1)),
    Fault("fem: delta 0.1 % high", ("fem",), seams.FEM_VELOCITY, with_scheme(0, gamma=thousandth)),
    Fault("fem: joints 1e-6 stiff", ("fem",), seams.LINE_SPRINGS, times(1 + 1e-6)),
    Fault("fem: one step late", ("fem",), seams.LINE_HISTORIES, late),
    Fault("fem: 2 % high", ("fem",), seams.LINE_HISTORIES, times(1.02)),
    Fault("layers: one per cent deep", ("layers",), seams.LAYERS_THROUGH, deeper),
]  # fmt: skip

# ---- sub-blocks ------------------------------------------------------------------------------------------------------


def soft_glue(sound):
    """Glue with half the stiffness."""
    return lambda model, columns, rows, glue, pattern: sound(model, columns, rows, glue / 2, pattern)


SUBBLOCKS = [
    Fault("joints: base springs 1e-6 stiff", DDA, seams.SYSTEM_BASE, times(1 + 1e-6)),
    Fault("joints: glue of half the stiffness", DDA, seams.SYSTEM_GLUE, soft_glue),
    Fault("joints: rows of a point 1e-6 long", DDA, seams.SYSTEM_JOINT_ROWS, times(1 + 1e-6)),
    Fault("system: mass 0.1 % heavy", DDA, seams.SYSTEM_MASS, times(1.001)),
    Fault("system: loads 1e-6 high", DDA, seams.SYSTEM_LOAD, times(1 + 1e-6)),
    Fault("system: forces of half the flexibility", DDA, seams.SYSTEM_FLEXIBILITY, times(0.5)),
    Fault("system: delta 0.1 % high", DDA, seams.SYSTEM_VELOCITY, with_scheme(0, delta=thousandth)),
    Fault("system: delta forgotten", DDA, seams.SYSTEM_VELOCITY, with_scheme(0, delta=no_damping)),
    Fault("system: one step late", DDA, seams.SYSTEM_RUN, late),
    Fault("dda: springs 1e-9 stiff", DDA, seams.DDA_STIFFNESS, times(1 + 1e-9)),
    Fault("fem: nodal springs of half the length", ("fem",), seams.FEM_FOUNDATION, times(2.0)),
    Fault("fem: foundation 5 % soft", ("fem",), seams.FEM_FOUNDATION, times(1.05)),
    Fault("fem: mass 5 % heavy", ("fem",), seams.FEM_MASS, times(1.05)),
    Fault("fem: rotation of the other sign", ("fem",), seams.FEM_ROTATION, times(-1.0)),
    Fault("fem: delta 0.1 % high", ("fem",), seams.FEM_VELOCITY, with_scheme(0, gamma=thousandth)),
]

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


STABILITY = [
    Fault("dda: the printed recursion", DDA, seams.DDA_SOLVE, printed_recursion),
    Fault("dda: modes by a general solver", DDA, seams.DDA_MODES, unscaled_modes),
    Fault("dda: load 2e-9 high", DDA, seams.DDA_LOAD, times(1 + 2e-9)),
    Fault("dda: delta 0.1 % high", DDA, seams.DDA_VELOCITY, with_scheme(0, delta=thousandth)),
    Fault("dda: an offset", DDA, seams.DDA_OVERFLOW, offset),
    Fault("dda-textbook: the robust form", ("dda-textbook",), seams.DDA_TEXTBOOK, robust_form),
]


STIFF_CONTACT = [
    Fault("dda: delta 0.1 % high", DDA, seams.DDA_VELOCITY, with_scheme(0, delta=thousandth)),
    Fault("dda: one step late", DDA, seams.DDA_HISTORIES, late),
    Fault("dda: an offset", DDA, seams.DDA_OVERFLOW, offset),
]


def of_degree(degree):
    """Build every mesh of one degree."""
    return lambda sound: lambda mesh, asked: sound(mesh, degree)


LIMITS = [
    Fault("dda: delta 1e-6 high", DDA, seams.DDA_VELOCITY, with_scheme(0, delta=lambda d: d + 1e-6)),
    Fault("fem: always linear", ("fem",), seams.FEM_BASIS, of_degree(1)),
    Fault("fem: always quadratic", ("fem",), seams.FEM_BASIS, of_degree(2)),
]

# ---- blocks that move in the plane -----------------------------------------------------------------------------------


def with_springs(**changes):
    """Change what the springs of contacts have, stated or found, by functions of their law or by factors."""

    def other(law):
        if law is None:
            return None
        if not isinstance(law, dda.ContactSprings):  # of each pair of blocks its own
            return lambda first, second: other(law(first, second))
        values = {name: change(law) if callable(change) else change * (getattr(law, name) or 0.0)
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


def in_plane(name, replacement):
    """Enter a fault where histories of blocks in the plane are made."""
    return Fault(f"dda: {name}", DDA, seams.PLANE, replacement)


def outlines(size):
    """Multiply the corners of the blocks that move about their centroids."""

    def change(block):
        centroid = block.block.section.centroid
        return {} if block.fixed else {"vertices": centroid + size * (block.block.corners - centroid)}

    return of_blocks(change)


HEAVIER = in_plane("density 0.1 % high", with_blocks(density=1.001))
STIFFER = in_plane("p doubled", with_springs(stiffness=2.0))
SMOOTHER = in_plane("friction halved", with_springs(friction=0.5))
UNACCOUNTED = in_plane("1e-9 of the energy lost", accounted(balance=lambda energy: 1e-9 * energy["kinetic"]))
MEETING = [HEAVIER, STIFFER, SMOOTHER, in_plane("glue 0.1 % soft", with_bonds(0.999))]
SPIN = [
    HEAVIER,
    SMOOTHER,
    UNACCOUNTED,
    Fault("dda: no centrifugal strain", DDA, seams.PLANE_PULL, times(0.0)),
    in_plane("weight 0.1 % high", with_weight(1.001)),
    in_plane("spin 0.1 % high", with_blocks(spin=1.001)),
]
PUSHING = [HEAVIER, STIFFER, SMOOTHER, UNACCOUNTED, in_plane("friction 2 % high", with_springs(friction=1.02))]
BOXES = [
    in_plane("tan(phi) a thousandth high", with_springs(friction=1.001)),
    in_plane("springs a millionth stiff", with_springs(stiffness=1 + 1e-6)),
    in_plane("density a millionth high", with_blocks(density=1 + 1e-6)),
    in_plane("velocity half a per cent low", with_blocks(velocity=0.995)),
    in_plane("spin half a per cent high", with_blocks(spin=1.005)),
]
STANDING = [
    in_plane("weight upside down", with_weight(-1.0)),
    in_plane("weight a hundredth high", with_weight(1.01)),
    in_plane("weight turned up the dip", with_weight(turned=-1.5)),
    in_plane("weight turned down the dip", with_weight(turned=1.5)),
    in_plane("contacts that pull", with_springs(tension=lambda law: 1e6, cohesion=lambda law: 1e7 * law.shear)),
    in_plane("friction a twentieth high", with_springs(friction=lambda law: law.friction and 1.05 * law.friction)),
    in_plane("friction a twentieth low", with_springs(friction=lambda law: law.friction and 0.95 * law.friction)),
    in_plane("nothing slips", with_springs(friction=lambda law: None)),
    in_plane("springs a tenth stiff", with_springs(stiffness=1.1)),
    in_plane("springs a tenth soft", with_springs(stiffness=0.9)),
    in_plane("load in no account", accounted(balance=lambda energy: energy["balance"] + 1e-6 * energy["load"])),
]
RISING = accounted(
    kinetic=lambda energy: (1 + 1e-9 * np.arange(len(energy["kinetic"]))) * energy["kinetic"],
    balance=lambda energy: energy["balance"] + 1e-9 * energy["kinetic"],
)
TOUCHING = [
    in_plane("no contact is found", with_springs(stiffness=lambda law: 1e-3)),
    in_plane("contacts stick", with_springs(shear=lambda law: law.stiffness, friction=lambda law: None)),
    in_plane("springs a hundredth stiff", with_springs(stiffness=1.01)),
    in_plane("the block a hundredth small", outlines(0.99)),
    in_plane("the block half as wide again", outlines(np.array([1.5, 1.0]))),
    in_plane("blocks spin", of_blocks(lambda block: {} if block.fixed else {"spin": 1.1 * block.spin + 0.02})),
    in_plane("energy rises", RISING),
]

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


BLOCK, BAR = ("block-events",), ("bar-events",)
IMPACTS = [
    Fault("block: springs", BLOCK, seams.EVENTS_BLOCK, scaled(stiffness=1.01)),
    Fault("block: speed and fall", BLOCK, seams.EVENTS_BLOCK, scaled(velocity=1 + 1e-9, gap=1 + 1e-9)),
    Fault("block: density", BLOCK, seams.EVENTS_BLOCK, scaled(density=1 + 1e-8)),
    Fault("block: density, coarsely", BLOCK, seams.EVENTS_BLOCK, scaled(density=1 + 1e-5)),
    Fault("block: springs a hundredth as stiff", BLOCK, seams.EVENTS_BLOCK, scaled(stiffness=0.01)),
    Fault("bar: springs", BAR, seams.EVENTS_BAR, scaled(base_stiffness=1.01)),
    Fault("bar: gap", BAR, seams.EVENTS_BAR, scaled(gap=1 + 1e-9)),
    Fault("bar: density", BAR, seams.EVENTS_BAR, scaled(density=1 + 1e-8)),
    Fault("bar: springs a hundredth as stiff", BAR, seams.EVENTS_BAR, scaled(base_stiffness=0.01)),
    Fault("dda: gaps", ("dda",), seams.DDA_OPENED, told(lambda r: {"gap": 1.001 * r.gap})),
]
OPENING = [  # of the data by parts in 1e11 and less, which move every number by about as much
    Fault("block: springs", BLOCK, seams.EVENTS_BLOCK, scaled(stiffness=1 + 4e-11)),
    Fault("block: density", BLOCK, seams.EVENTS_BLOCK, scaled(density=1 + 4e-11)),
    Fault("block: load", BLOCK, seams.EVENTS_BLOCK, scaled(pressure=1 + 4e-12)),
    Fault("bar: springs", BAR, seams.EVENTS_BAR, scaled(base_stiffness=1 + 1e-9)),
    Fault("bar: density", BAR, seams.EVENTS_BAR, scaled(density=1 + 4e-11)),
    Fault("bar: load", BAR, seams.EVENTS_BAR, scaled(pressure=1 + 4e-12)),
    Fault("block: an open contact carries something", BLOCK, seams.EVENTS_BLOCK, carrying),
    Fault("bar: an open contact carries something", BAR, seams.EVENTS_BAR, carrying),
    Fault("block: springs 1 % stiff", BLOCK, seams.EVENTS_BLOCK, scaled(stiffness=1.01)),
    Fault("block: springs 10 % stiff", BLOCK, seams.EVENTS_BLOCK, scaled(stiffness=1.1)),
    Fault("fem: mass 1e-6 heavy", ("fem",), seams.FEM_OPENED_COLUMN, told(lambda model: {"M": (1 + 1e-6) * model.M})),
    Fault("bar: mid-height 1e-6 off", ("bar",), seams.BAR_OPENED, off_in_the_middle),
]
REBOUND = [
    Fault("one more solve counted", DDA, seams.DDA_OPENED, told(lambda r: {"step_solves": r.step_solves + 2})),
    Fault("a rebound a millionth too fast", DDA, seams.DDA_OPENED,
          told(lambda r: {"velocity": r.velocity + 1e-6 * np.maximum(r.velocity, 0.0)})),
    Fault("a few joules too many", DDA, seams.DDA_OPENED, energy_changed("kinetic", lambda e: e + 9e4)),
    Fault("a switch lost", ("block-events",), seams.EVENTS_BLOCK, fewer),
]  # fmt: skip

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


FEM = ("fem",)
PATCH = [
    Fault("plane strain for plane stress", DDA, seams.PLANE_MATERIAL, in_plane_strain),
    Fault("half of the shear lost in T", DDA, seams.SYSTEM_JOINT_ROWS, without_half_of_the_shear),
    Fault("glue across half", DDA, seams.GLUED_EDGES, glued_by(0.5)),
    Fault("traction a thousandth high", DDA, seams.GLUED_LOAD, traction_times(1.001)),
    Fault("modulus a millionth high", FEM, seams.FEM_PLANE_STIFFNESS, times(1 + 1e-6)),
]
BEAMS = [
    Fault("modulus six per cent high", DDA, seams.PLANE_MATERIAL, harder(1.06)),
    Fault("rotary inertia a fiftieth high", DDA, seams.SYSTEM_MASS, times(1.02)),
    Fault("modulus a thousandth high", FEM, seams.FEM_PLANE_STIFFNESS, times(1.001)),
]
PLATES = [
    Fault("modulus a millionth high", DDA, seams.PLANE_MATERIAL, harder(1 + 1e-6)),
    Fault("modulus a hundredth high", DDA, seams.PLANE_MATERIAL, harder(1.01)),
    Fault("glue across a thousandth high", DDA, seams.GLUED_EDGES, glued_by(1.001)),
    Fault("modulus a fifth high", DDA, seams.PLANE_MATERIAL, harder(1.2)),
    Fault("tractions a thousandth high", DDA, seams.TRACTION, pulled(1.001)),
    Fault("tractions a fifth high", DDA, seams.TRACTION, pulled(1.2)),
    Fault("modulus three hundredths high", FEM, seams.FEM_PLANE_STIFFNESS, times(1.03)),
]

# ---- blocks that turn ------------------------------------------------------------------------------------------------


def read_as(change):
    """Return a wrapper that changes what a property tells."""
    return lambda sound: property(lambda model: change(sound.__get__(model)))


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


def turning_by(rotation):
    return lambda sound: lambda Q, r, exact, out: sound(Q, r, rotation == EXACT, out)


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


LIGHT = Fault("weight 1 % less", DDA, seams.ROLLING_WEIGHT, read_as(lambda g: 0.99 * g))
STEEP = Fault("slope 0.5 deg more", DDA, seams.ROLLING_WEIGHT, read_as(lambda g: turned(math.radians(0.5)) @ g))
HEAVY = Fault("moment of inertia 2 % more", DDA, seams.ROLLING_MODES, heavy)
SOFT = Fault("springs a tenth", DDA, seams.ROLLING_LAWS, scaled(stiffness=0.1))
QUICK = Fault("velocities 1 % more in every step", DDA, seams.ROLLING_STEPS, quicker(0.01))
TILTED = Fault("tilt 1 % more", DDA, seams.ROLLING_START, scaled(tilt=1.01))
ROCKING = [
    LIGHT,
    HEAVY,
    SOFT,
    QUICK,
    Fault("velocities 5 % more in every step", DDA, seams.ROLLING_STEPS, quicker(0.05)),
    TILTED,
    Fault("rotation reported twice its size", DDA, seams.ROLLING_OBSERVED, doubled),
    Fault("forces at the end of the step", DDA, seams.ROLLING_LATE, lambda sound: lambda delta: 1.0),
    Fault("base moves 2 % more", DDA, seams.ROLLING_BASE, further(0.02)),
    Fault("base moves 30 % more", DDA, seams.ROLLING_BASE, further(0.3)),
]
TOPPLING = [
    LIGHT,
    STEEP,
    HEAVY,
    SOFT,
    TILTED,
    Fault(
        "friction 1 % less",
        DDA,
        seams.ROLLING_LAWS,
        of_first(lambda law: {"friction": law.friction and 0.99 * law.friction}),
    ),
    Fault("first-order rotation", DDA, seams.ROLLING_TURN, turning_by(FIRST_ORDER)),
    Fault("exact rotation where first-order is asked for", DDA, seams.ROLLING_TURN, turning_by(EXACT)),
    Fault("the outline grows twice", DDA, seams.ROLLING_TURN, grown_twice),
    Fault("velocities a thousandth more in every step", DDA, seams.ROLLING_STEPS, quicker(1e-3)),
]

KILLS = {
    "meeting": MEETING,
    "spin": SPIN,
    "pushing": PUSHING,
    "boxes": BOXES,
    "standing": STANDING,
    "touching": TOUCHING,
    "patch": PATCH,
    "beams": BEAMS,
    "plates": PLATES,
    "rocking": ROCKING,
    "toppling": TOPPLING,
    "impacts": IMPACTS,
    "opening": OPENING,
    "rebound": REBOUND,
    "columns": COLUMNS,
    "waves": WAVES,
    "subblocks": SUBBLOCKS,
    "stability-small": STABILITY,
    "stiff-contact": STIFF_CONTACT,
    "limits": LIMITS,
}
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
    "plates": {
        "plates-disc": ("modulus a fifth high", "tractions a fifth high"),
        "plates-glue": ("modulus a hundredth high",),
        "plates-hole": ("modulus a fifth high", "tractions a fifth high"),
    },
}
SHORT = {  # some gates and the faults that bite them, in the short tests
    "columns": (
        ("columns-domino", "columns-settle[time.step=0.02", "columns-slips-steps[time.step=0.005"),
        COLUMNS[:3],
    ),
    "waves": (
        ("waves-blocks[time.alpha=0.5,time.delta=1,time.step=0.001", "waves-glue[column.glue=2e+10"),
        [WAVES[0], WAVES[2], WAVES[6]],
    ),
}


@pytest.mark.long
@pytest.mark.parametrize("name", KILLS)
def test_every_gate_is_bitten_and_every_fault_is_seen(name, tmp_path, finished_cases):
    def is_checked(gate):
        return not any(word in part for word in LEFT_OUT.get(name, ()) for part in (gate.scene, *gate.pair))

    check_study(name, KILLS[name], tmp_path, finished_cases, is_checked, FIRST.get(name))


@pytest.mark.parametrize("name", SHORT)
def test_gates_of_some_scenes_are_bitten(name, tmp_path, finished_cases):
    words, faults = SHORT[name]
    check_study(name, faults, tmp_path, finished_cases, lambda gate: gate.scene.startswith(words))


@pytest.mark.long
@pytest.mark.parametrize("name", ("stability-small", "stiff-contact", "limits"))
def test_every_gate_passes_and_the_chapter_is_written(name, tmp_path, finished_cases):
    results = beside(finished_cases, tmp_path / "results")
    assert {verdict.status for verdict in run_study(get_study(name), results)} == {Status.PASS}
    assert build(results, tmp_path / "report.pdf").stat().st_size > 20_000
    assert all(path.exists() for path in write_figures(results, tmp_path / "figures", [name]))
