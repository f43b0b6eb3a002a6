"""What cannot be is refused by its field, in one table for all problems, bodies, laws and schemes of the elements."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from oracles.elements import SQUARE, make
from skfem import MeshTri

from fem_reference import Bar, Friction, Motion, PatchContact, PlaneBody, PlaneModel, Scheme, Unilateral, named_scheme
from fem_reference.column.contact_model import ColumnContact, ContactColumn
from fem_reference.column.contacts import solve_contacts
from fem_reference.column.problem import Excitation, Ground, Stratum
from fem_reference.column.stepping import solve_line
from fem_reference.events import bar_events, bars_events, block_events
from fem_reference.events.bars_model import Bar as WaveBar
from fem_reference.events.bars_model import BarJoint, BarsProblem
from fem_reference.events.block_model import BlockProblem
from fem_reference.events.column_drive import ricker
from fem_reference.events.column_model import ColumnBlock, ColumnJoint, ColumnProblem
from fem_reference.events.restitution import ContactScheme, restitution
from fem_reference.exact import rocking, sliding_block
from fem_reference.exact.layers import solve_layers
from fem_reference.exact.opening_bar import OpeningBar
from fem_reference.history.solver import solve
from fem_reference.history.unilateral import solve_unilateral
from fem_reference.problem.bar import BarProblem

INF, NAN = math.inf, math.nan
UP = ((0.0, 0.0), (1.0, 0.0))
INSIDE = ((0.0, 0.5), (1.0, 0.5))
HOOK = ((0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (2.9, 3.0), (2.9, 0.1), (0.0, 0.1))

CONSTANT = Scheme(0.5, 1.0, 1.0, 1e-3)
EXPLICIT = replace(CONSTANT, alpha=0.0)
AVERAGE = Scheme(0.25, 0.5, 1.0, 1e-3)
LEAPFROG = named_scheme("leapfrog", step=1e-4)
COMPOSITE = named_scheme("composite", step=1e-3)
ALPHA = named_scheme("chung-hulbert", step=1e-3, rho_inf=0.5)
WAVES = Bar.of(make())
OPENING_WAVES = OpeningBar.of(make())
BAR = BarProblem(2.0, 2.0, 2700.0, 1e9, 2e9, 5e6)
BLOCK = BlockProblem(2.0, 2.0, 2700.0, 1e9, 1e9, 5e6)
RIGID = {"stiffness": INF, "restitution": 0.5}
RUBBING = {"friction": 30.0, "shear_stiffness": 1e8}
STRATA = (Stratum(1.0, 2500.0, 1e9, 0.0),) * 2
STANDING = ContactColumn(
    Ground(STRATA, "pressure"), "unilateral", (ColumnContact(0.0, 2e9), ColumnContact(1.0, 1e9)), (0.0, 0.0)
)
ON_WAVES = Ground(STRATA, "shear", (), 5e5)
SLIPPING = ContactColumn(ON_WAVES, "frictional", (ColumnContact(1.0, 1e8),), (0.0, 0.0))
BLOCKS = ColumnProblem((ColumnBlock(1.0, 2500, 1e9),) * 2, (ColumnJoint(1e9), None))
WAVE = WaveBar(1.0, 1.0, 1.0)
PAIR = BarsProblem((WAVE, WAVE), (None, BarJoint("unilateral", 5.0)))
BODY = PlaneBody((((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)),), 2700.0, 1e9, 0.25, rectangle=True, elements=2)
FLOOR = PatchContact(0, None, (0.0, 0.0), (0.25, 0.0), (0.0, 1.0), 1e9)
SLIDER = sliding_block.SlidingBlock(20.0, 30.0)
STILL = sliding_block.moved([0.0], [0.0])
ROCKER = rocking.RockingBlock(0.8, 2.0)

VALUES = [  # a sound thing, and what each of its fields may not be
    (WAVES, {"young": [-1e9]}),
    (BAR, {"height": [0.0], "base_stiffness": [-1.0], "gap": [-1e-3], "pressure": [INF]}),
    (BLOCK, {"width": [0.0], "young": [-1.0], "gap": [-1e-3], "poisson": [1.0], "hypothesis": ["plain"]}),
    (BLOCK, {"eccentricity": [1.0], "pressure": [NAN], "damping": [NAN], "stiffness": [INF], "cohesion": [1e3]}),
    (replace(BLOCK, **RUBBING), {"friction": [90.0, -1.0], "cohesion": [-1.0], "slope": [90.0]}),
    (replace(BLOCK, **RUBBING), {"shear_stiffness": [0.0]}),
    (replace(BLOCK, **RIGID), {"restitution": [-0.1, 1.01, NAN]}),
    (STANDING, {"contacts": [(), STANDING.contacts[::-1], (ColumnContact(2.0, 1e9),)], "velocities": [(1.0,)]}),
    (BLOCKS, {"gravity": [INF], "joints": [(None,)], "law": ["glued"]}),
    (BLOCKS.blocks[0], {"density": [-1.0], "height": [INF], "velocity": [NAN]}),
    (BLOCKS.joints[0], {"stiffness": [INF], "gap": [-0.1], "strength": [-1.0]}),
    (WAVE, {"length": [0.0], "modulus": [INF], "velocity": [NAN]}),
    (PAIR, {"joints": [()], "settled": [True]}),
    (PAIR.joints[1], {"stiffness": [-1.0], "gap": [-0.1]}),
    (BODY, {"poisson": [0.5], "density": [0.0], "hypothesis": ["bending"], "elements": [0], "degree": [3]}),
    (BODY, {"mesh": [MeshTri()]}),
    (FLOOR, {"normal": [(0.0, 2.0)], "second": [0], "stiffness": [0.0], "cohesion": [1.0]}),
    (SLIDER, {"slope": [90.0], "friction": [-1.0], "gravity": [-1.0], "cohesion": [NAN]}),
    (ROCKER, {"width": [0.0], "height": [-1.0], "gravity": [INF], "restitution": [1.1]}),
    (make(), {"poisson": [-1.0], "stiffness": [0.0, NAN], "shear_stiffness": [-1.0], "hypothesis": ["stress"]}),
    (make(), {"degree": [3], "elements": [0], "top": [0], "base": [4], "vertices": [SQUARE[::-1]]}),
    (make(), {"patch_width": [0.5]}),
    (make(foundation="patch", patch_width=0.5), {"patch_width": [None, 1.1]}),
    (Unilateral(), {"gap": [-1e-3], "velocity": [INF], "shear": ["rough"], "limit": [0], "cut": [1.0]}),
    (Unilateral(), {"shortest": [0.0], "rule": ["explicit"], "friction": [Friction(30.0)]}),
    (Friction(30.0), {"cohesion": [-1.0]}),
    (ALPHA, {"mass_damping": [1.0]}),
]  # fmt: skip

TOGETHER = [  # what is refused, and what it does not go with
    (BLOCK, "damping", {"damping": 1e3, **RUBBING}),
    (BLOCK, "damping", {"damping": 1e3, "locked": True}),
    (BLOCK, "damping", {"damping": 1e3, **RIGID}),
    (BLOCK, "stiffness", {"restitution": 0.5}),
    *((BLOCK, "restitution", RIGID | other) for other in (RUBBING, {"eccentricity": 0.3}, {"traction": 1e5})),
    *((BLOCK, "restitution", RIGID | other) for other in ({"slope": 5.0}, {"base": Motion((0.0,), (0.0,), (0.0,))})),
    (STANDING, "contacts", {"unsupported": True}),
    (STANDING.contacts[0], "contacts", {"stiffness": -1.0}),
    (STANDING, "joints", {"ground": replace(STANDING.ground, joints=((1.0, 1e9),))}),
    (STANDING, "settled", {"law": "frictional", "settled": True}),
    (BLOCKS, "joints[0].strength", {"joints": (ColumnJoint(1e9, strength=1.0), None)}),
    (BLOCKS, "joints[0].gap", {"law": "frictional", "joints": (ColumnJoint(1e9, 0.1), None)}),
    (BLOCKS, "joints[0]", {"base": "free"}),
    (BLOCKS, "impedance", {"base": "transmitting", "joints": (None, None)}),
    (PAIR, "bars", {"bars": (), "joints": ()}),
    (PAIR.joints[1], "gap", {"law": "frictional", "stiffness": INF, "gap": 0.1}),
    (PAIR.joints[1], "strength", {"law": "frictional", "strength": 0.0}),
    (FLOOR, "gap", {"bonded": True, "gap": 0.1}),
    (BODY, "velocity", {"spin": 1.0, "clamps": (UP,)}),
    (make(), "poisson", {"poisson": 0.5, "hypothesis": "plane strain"}),
]


def rest(steps):
    return Excitation(*[np.zeros(steps + 1)] * 4)


def scheme(name, **options):
    return named_scheme(name, **{"step": 1e-3} | options)


def lines(step=AVERAGE, column=STANDING, columns=()):
    return solve_contacts(column, [1, 1], 1, step, rest(1), columns, [0.5])


ASKS = {
    "alpha": [lambda: ContactScheme(0.0, 0.5)],
    "delta": [lambda: ContactScheme(0.25, 0.8)],
    "omega": [lambda: restitution(ContactScheme(0.5, 1.0), 0.0, 0.5)],
    "theta": [lambda: restitution(ContactScheme(0.5, 1.0), 1.0, 1.5)],
    "gg": [
        lambda: ContactScheme(0.5, 1.0, 0.0),
        lambda: scheme("composite", gg=1.1),
        lambda: WAVES.continuum(replace(CONSTANT, gg=0.0), 10),
        lambda: solve_layers(ON_WAVES, replace(AVERAGE, gg=0.0), 10, rest, ("displacement",)),
    ],
    "name": [lambda: scheme("bathe"), lambda: scheme("newmark")],
    "rho_inf": [
        lambda: scheme("chung-hulbert"),
        lambda: scheme("wbz", rho_inf=1.01),
        lambda: scheme("hht", rho_inf=0.49),
        lambda: scheme("composite", rho_inf=NAN),
        lambda: scheme("leapfrog", rho_inf=1.0),
    ],
    "split": [lambda: scheme("composite", split=1.0), lambda: scheme("chung-hulbert", rho_inf=0.5, split=0.5)],
    "start": [lambda: scheme("leapfrog", start="zero")],
    "step": [lambda: scheme("composite", step=0.0)],
    "scheme": [
        lambda: WAVES.solve(EXPLICIT, 10),
        lambda: WAVES.solve(replace(EXPLICIT, alpha=1 / 6, delta=0.5), 10),
        lambda: WAVES.solve(replace(CONSTANT, delta=0.4), 10),
        lambda: WAVES.solve(LEAPFROG, 10),
        lambda: OPENING_WAVES.solve(EXPLICIT, 1),
        lambda: OPENING_WAVES.solve(COMPOSITE, 3),
        lambda: solve_line(ON_WAVES, [1, 1], 1, LEAPFROG, rest(3)),
        lambda: lines(LEAPFROG, SLIPPING),
        lambda: lines(LEAPFROG, replace(STANDING, contacts=(ColumnContact(0.0, INF),))),
        lambda: solve(make(), ALPHA, 3, floor=0.0),
    ],
    "alpha, delta": [lambda: solve_unilateral(make(elements=2), CONSTANT, 1, Unilateral(rule="implicit"))],
    "steps": [
        lambda: WAVES.continuum(replace(CONSTANT, step=1.0), 10),
        lambda: WAVES.continuum(Scheme(0.5, 1.0, 1 - 1e-6, WAVES.travel / 2), 20000),
        lambda: OPENING_WAVES.solve(CONSTANT, 0),
        lambda: solve(make(elements=2), CONSTANT, 0),
        lambda: solve_unilateral(make(elements=2), CONSTANT, 0),
    ],
    "columns": [
        *(lambda name=name: lines(columns=(name,)) for name in ("force_1", "turn_1", "velocity_2", "velocity")),
        lambda: solve(make(elements=2), CONSTANT, 1, columns=("strain_x",)),
    ],
    "fields": [lambda: solve(make(elements=2), CONSTANT, 1, fields="block.txt")],
    "problem": [
        lambda: OpeningBar.of(make(poisson=0.1)),
        lambda: OpeningBar.of(make(traction=1.0)),
        lambda: OpeningBar.of(make(foundation="corner")),
        lambda: OpeningBar.of(make(motion=Motion((0.0, 1.0), (0.0, 0.0), (0.0, 1e-3)))),
        lambda: OpeningBar.of(make(((0, 0), (2, 0), (2, 2), (0.1, 2)))),
    ],
    "gap": [lambda: OpeningBar.of(make(), gap=-1.0)],
    "velocity": [lambda: OpeningBar.of(make(), velocity=NAN)],
    "friction": [lambda: Friction(-1.0), lambda: Friction(90.0)],
    "end": [
        lambda: bar_events.solve(BAR, INF),
        lambda: block_events.solve(BLOCK, 0.0),
        lambda: bars_events.solve(PAIR, 0.0),
        lambda: sliding_block.solve(SLIDER, STILL, 0.0),
        lambda: rocking.solve(ROCKER, 0.0, 0.1),
    ],
    "digits": [lambda: block_events.solve(BLOCK, 1.0, digits=10), lambda: bars_events.solve(PAIR, 1.0, digits=10)],
    "times": [
        lambda: bar_events.solve(BAR, 0.01).at([-0.02]),
        lambda: block_events.solve(BLOCK, 0.01).at([0.02]),
        lambda: bars_events.solve(PAIR, 1.0).at([2.0]),
        lambda: sliding_block.solve(SLIDER, STILL, 1.0).at([2.0]),
    ],
    "height": [
        lambda: solve_line(ON_WAVES, [1, 1], 1, AVERAGE, rest(3), (), [2.5]),
        lambda: solve_line(ON_WAVES, [1, 1], 1, AVERAGE, rest(3), (), [-0.5]),
        lambda: bars_events.solve(PAIR, 1.0).point(0, 2.0, [0.5]),
    ],
    "drive": [lambda: bars_events.solve(replace(PAIR, top=ricker(1.0, 2.0)), 1.0)],
    "tilt": [lambda: ROCKER.quarter_period(1.0), lambda: rocking.solve(ROCKER, 1.0, 2.0)],
    "recorded": [lambda: sliding_block.recorded([0, 1], [1]), lambda: sliding_block.recorded([0.5, 1], [1, 1])],
    "moved": [lambda: sliding_block.moved([0, 0], [1, 1])],
    "motion": [
        lambda: Motion((), (), ()),
        lambda: Motion((0.0, 1.0), (0.0,), (0.0, 0.0)),
        lambda: Motion((0.0, 1.0), (0.0, NAN), (0.0, 0.0)),
        lambda: Motion((0.0, 1.0), (0.0, 0.0), (INF, 0.0)),
        lambda: Motion((0.0, NAN), (0.0, 0.0), (0.0, 0.0)),
        lambda: Motion((0.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
        lambda: Motion((1.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
        lambda: solve_unilateral(make(motion=Motion((0.0, 1.0), (1e-6, 0.0), (0.0, 0.0))), CONSTANT, 1),
    ],
    "vertices": [lambda: solve(make(((0, 0), (2, 0), (3, 1), (2, 2), (0, 2)), top=3), CONSTANT, 1)],
    "edge": [
        lambda: PlaneModel([replace(BODY, clamps=(INSIDE,))]),
        lambda: PlaneModel([replace(BODY, tractions=((INSIDE, (1.0, 0.0)),))]),
        lambda: PlaneModel([BODY]).observer(*INSIDE),
        lambda: PlaneModel([BODY], [replace(FLOOR, end=(2.0, 0.0))]),
    ],
    "load": [
        lambda: PlaneModel([replace(BODY, tractions=((UP, (1.0, 0.0)),))]).rest,
        lambda: PlaneModel([replace(BODY, gravity=(1.0, 0.0))], [FLOOR]).rest,
    ],
    "stress": [lambda: PlaneModel([BODY]).stress_error()],
    "polygons": [lambda: PlaneModel([replace(BODY, polygons=(HOOK,), rectangle=False)])],
    "contact": [lambda: PlaneModel([BODY], [replace(FLOOR, first=1)])],
    "rollers": [lambda: PlaneModel([replace(BODY, rollers=((UP, "z"),))])],
}  # fmt: skip

CASES = [(field, lambda t=t, change=change: replace(t, **change)) for t, field, change in TOGETHER]
for sound, fields in VALUES:
    CASES += [(f, lambda t=sound, f=f, v=v: replace(t, **{f: v})) for f, values in fields.items() for v in values]
CASES += [(field, ask) for field, asks in ASKS.items() for ask in asks]


@pytest.mark.parametrize(("field", "ask"), CASES, ids=[field for field, _ in CASES])
def test_what_cannot_be_is_refused_by_its_field(field, ask):
    with pytest.raises(ValueError, match=rf"^{re.escape(field)}: \w"):
        ask()
