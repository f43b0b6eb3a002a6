"""Kill matrices of studies: every gate is bitten by a seeded fault, and every fault is seen by a gate.

Those of studies that have tests of their own stand beside these.
"""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from conftest import beside
from faults import seams
from faults.fault import Fault, late, no_damping, no_discount, of_first, thousandth, times, told, with_scheme
from faults.kill_matrix import check_study

import dda
from dda.bodies.gap_form import ModalForm
from validation.engine.run import run_study
from validation.gates.gate import Status
from validation.report.book import build, write_figures
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

# Larger systems take seconds a fault: their gates measure what those of the smaller ones measure.
LEFT_OUT = (
    "subblocks-locking",
    "16x16",
    "1x16",
    "1x32",
    "5x5",
    "=4x4,fem",
    "8x8",
    "=100,",
    "=10]",
    "width=0.6",
    "width=0.2",
)


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


def with_springs(**factors):
    """Multiply what the springs of contacts have, of stated ones and of those that are found."""

    def other(springs):
        return replace(springs, **{name: factor * (getattr(springs, name) or 0.0) for name, factor in factors.items()})

    def change(model):
        contacts = [replace(contact, springs=other(contact.springs)) for contact in model.contacts]
        return {"contacts": contacts, "found": model.found and other(model.found)}

    return of_first(change)


def with_blocks(**factors):
    """Multiply what blocks have."""
    return of_first(
        lambda model: {
            "blocks": [
                replace(block, **{name: factor * getattr(block, name) for name, factor in factors.items()})
                for block in model.blocks
            ]
        }
    )


def with_bonds(factor):
    """Multiply the normal springs of glue."""
    return of_first(lambda model: {"bonds": [replace(bond, stiffness=factor * bond.stiffness) for bond in model.bonds]})


def with_gravity(factor):
    """Multiply the acceleration."""
    return of_first(lambda model: {"gravity": tuple(factor * g for g in model.gravity)})


def lost(share):
    """Let a share of the kinetic energy go unaccounted."""
    return told(lambda result: {"energy": result.energy | {"balance": share * result.energy["kinetic"]}})


HEAVIER = Fault("dda: density 0.1 % high", DDA, seams.PLANE, with_blocks(density=1.001))
STIFFER = Fault("dda: p doubled", DDA, seams.PLANE, with_springs(stiffness=2.0))
SMOOTHER = Fault("dda: friction halved", DDA, seams.PLANE, with_springs(friction=0.5))
UNACCOUNTED = Fault("dda: 1e-9 of the energy lost", DDA, seams.PLANE, lost(1e-9))
MEETING = [
    HEAVIER,
    STIFFER,
    SMOOTHER,
    Fault("dda: glue 0.1 % soft", DDA, seams.PLANE, with_bonds(0.999)),
]
SPIN = [
    HEAVIER,
    SMOOTHER,
    UNACCOUNTED,
    Fault("dda: no centrifugal strain", DDA, seams.PLANE_PULL, times(0.0)),
    Fault("dda: weight 0.1 % high", DDA, seams.PLANE, with_gravity(1.001)),
    Fault("dda: spin 0.1 % high", DDA, seams.PLANE, with_blocks(spin=1.001)),
]
ROUGHER = Fault("dda: friction 2 % high", DDA, seams.PLANE, with_springs(friction=1.02))
PUSHING = [HEAVIER, STIFFER, SMOOTHER, UNACCOUNTED, ROUGHER]

KILLS = {
    "meeting": MEETING,
    "spin": SPIN,
    "pushing": PUSHING,
    "columns": COLUMNS,
    "waves": WAVES,
    "subblocks": SUBBLOCKS,
    "stability-small": STABILITY,
    "stiff-contact": STIFF_CONTACT,
    "limits": LIMITS,
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
    left_out = LEFT_OUT if name == "subblocks" else ("waves-facts",)  # without runs, bitten in test_facts.py
    check_study(name, KILLS[name], tmp_path, finished_cases, lambda gate: not any(w in gate.scene for w in left_out))


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
