"""What the elements refuse, each by its field: `refusals.toml`, and below it what takes calls to ask for."""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from oracles.elements import SQUARE, make
from skfem import MeshTri

from fem_reference import Bar, Friction, Motion, PatchContact, PlaneBody, PlaneModel, Scheme, Unilateral, named_scheme
from fem_reference.column.contact_model import ColumnContact, ContactColumn
from fem_reference.column.contacts import solve_contacts
from fem_reference.column.problem import Excitation, Ground, Stratum
from fem_reference.column.stepping import solve_line
from fem_reference.events import bar_events, bars_events, block_events, column_events
from fem_reference.events.bars_model import Bar as WaveBar
from fem_reference.events.bars_model import BarJoint, BarsProblem
from fem_reference.events.block_model import BlockProblem
from fem_reference.events.column_drive import ricker
from fem_reference.events.column_model import ColumnBlock, ColumnJoint, ColumnProblem
from fem_reference.events.restitution import ContactScheme, restitution
from fem_reference.exact import rocking, sliding_block
from fem_reference.exact.layers import solve_layers
from fem_reference.exact.opening_bar import OpeningBar
from fem_reference.history.response import response
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
RIGID = {"stiffness": INF, "restitution": 1.0}
RUBBING = {"friction": 0.0, "shear_stiffness": 1e8}
STRATA = (Stratum(1.0, 2500.0, 1e9, 0.0),) * 2
STANDING = ContactColumn(
    Ground(STRATA, "pressure"), "unilateral", (ColumnContact(0.0, 2e9), ColumnContact(1.0, 1e9)), (0.0, 0.0)
)
ON_WAVES = Ground(STRATA, "shear", (), 5e5)
SLIPPING = ContactColumn(ON_WAVES, "frictional", (ColumnContact(1.0, 1e8),), (0.0, 0.0))
BLOCKS = ColumnProblem((ColumnBlock(1.0, 2500, 1e9),) * 2, (ColumnJoint(1e9), None))
WAVE = WaveBar(1.0, 1.0, 1.0)
PAIR = BarsProblem((WAVE, WAVE), (None, BarJoint("unilateral", 5.0)))
BODY = PlaneBody((((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)),), 2700.0, 1e9, 0.25, rectangle=True, elements=1)
FLOOR = PatchContact(0, None, (0.0, 0.0), (0.25, 0.0), (0.0, 1.0), 1e9)
SLIDER = sliding_block.SlidingBlock(20.0, 30.0)
STILL = sliding_block.moved([0.0], [0.0])
ROCKER = rocking.RockingBlock(0.8, 2.0)

SOUND = {  # what `refusals.toml` changes: much of it just so
    "waves": WAVES,
    "bar": BAR,
    "block": replace(BLOCK, eccentricity=0.9),
    "rubbing": replace(BLOCK, **RUBBING),
    "rigid": replace(BLOCK, **RIGID),
    "standing": STANDING,
    "contact": STANDING.contacts[0],
    "ground": STANDING.ground,
    "blocks": BLOCKS,
    "one_block": BLOCKS.blocks[0],
    "joint": BLOCKS.joints[0],
    "wave": WAVE,
    "pair": PAIR,
    "wave_joint": PAIR.joints[1],
    "body": BODY,
    "floor": FLOOR,
    "slider": replace(SLIDER, friction=0.0),
    "rocker": replace(ROCKER, restitution=1.0),
    "problem": make(poisson=0.5, eccentricity=0.9),
    "patches": make(foundation="patch", patch_width=1.0),
    "law": Unilateral(shortest=1.0),
    "newmark": CONSTANT,
    "friction": Friction(0.0),
    "averages": ALPHA,
}
TABLE = tomllib.loads(Path(__file__).with_name("refusals.toml").read_text())
TAKEN = TABLE.pop("taken")
TOGETHER = [  # what is refused, and what it does not go with, of parts that no table holds
    (BODY, "mesh", {"mesh": MeshTri()}),
    (BLOCK, "restitution", RIGID | {"base": Motion((0.0,), (0.0,), (0.0,))}),
    (STANDING, "contacts", {"contacts": STANDING.contacts[::-1]}),
    (STANDING, "contacts", {"contacts": (ColumnContact(2.0, 1e9),)}),
    (STANDING, "joints", {"ground": replace(STANDING.ground, joints=((1.0, 1e9),))}),
    (BLOCKS, "joints", {"joints": (None,)}),
    (BLOCKS, "joints[0].strength", {"joints": (ColumnJoint(1e9, strength=1.0), None)}),
    (BLOCKS, "joints[0].gap", {"law": "frictional", "joints": (ColumnJoint(1e9, 0.1), None)}),
    *((BLOCKS, "impedance", {"base": "transmitting", "joints": (None, None), "impedance": z}) for z in (0.0, INF)),
    (make(), "vertices", {"vertices": SQUARE[::-1]}),
    (SOUND["patches"], "patch_width", {"patch_width": None}),
    (Unilateral(), "friction", {"friction": Friction(30.0)}),
]


def rest(steps):
    return Excitation(*[np.zeros(steps + 1)] * 4)


def lines(step=AVERAGE, column=STANDING, columns=()):
    return solve_contacts(column, [1, 1], 1, step, rest(1), columns, [0.5])


ASKS = {
    "gg": [
        lambda: WAVES.continuum(replace(CONSTANT, gg=0.0), 10),
        lambda: solve_layers(ON_WAVES, replace(AVERAGE, gg=0.0), 10, rest, ("displacement",)),
        lambda: response(make(elements=1), replace(CONSTANT, gg=0.0), np.ones(1), exact=True),
    ],
    "start": [lambda: solve_line(replace(ON_WAVES, joints=((0.0, 1e9),)), [1, 1], 1, ALPHA, rest(3))],
    "blocks": [lambda: column_events.solve(ColumnProblem((ColumnBlock(1.0, 2500.0),), (None,)), 1.0)],
    "damping": [lambda: solve(make(motion=Motion((0.0,), (0.0,), (0.0,))), replace(CONSTANT, mass_damping=1.0), 1)],
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
        lambda: solve(make(elements=2), CONSTANT, 1, columns=("strain_x",)),
        lambda: solve_layers(ON_WAVES, AVERAGE, 10, rest, ("strain_x",)),
    ],
    "fields": [lambda: solve(make(elements=2), CONSTANT, 1, fields="block.txt")],
    "problem": [
        lambda: Bar.of(make(poisson=0.1)),
        lambda: OpeningBar.of(make(motion=Motion((0.0, 1.0), (0.0, 0.0), (0.0, 1e-3)))),
    ],
    "floor": [lambda: solve(make(), CONSTANT, 3, floor=-0.3), lambda: solve(make(), CONSTANT, 3, floor=1.1)],
    "gap": [lambda: OpeningBar.of(make(), gap=-1.0)],
    "velocity": [lambda: OpeningBar.of(make(), velocity=NAN)],
    "end": [
        lambda: bar_events.solve(BAR, INF),
        lambda: block_events.solve(BLOCK, 0.0),
        lambda: bars_events.solve(PAIR, 0.0),
        *(lambda end=end: sliding_block.solve(SLIDER, STILL, end) for end in (0.0, INF)),
        *(lambda end=end: rocking.solve(ROCKER, end, 0.1) for end in (0.0, INF)),
    ],
    "digits": [lambda: block_events.solve(BLOCK, 1.0, digits=10), lambda: bars_events.solve(PAIR, 1.0, digits=10)],
    "times": [
        lambda: bar_events.solve(BAR, 0.01).at([-0.02]),
        lambda: block_events.solve(BLOCK, 0.001).at([0.02]),
        lambda: bars_events.solve(PAIR, 1.0).at([2.0]),
        lambda: sliding_block.solve(SLIDER, STILL, 1.0).at([2.0]),
    ],
    "height": [
        lambda: solve_line(ON_WAVES, [1, 1], 1, AVERAGE, rest(3), (), [2.5]),
        lambda: solve_line(ON_WAVES, [1, 1], 1, AVERAGE, rest(3), (), [-0.5]),
        lambda: bars_events.solve(PAIR, 1.0).point(0, 2.0, [0.5]),
    ],
    "drive": [lambda: bars_events.solve(replace(PAIR, top=ricker(1.0, 2.0)), 1.0)],
    "tilt": [
        *(lambda tilt=tilt: ROCKER.quarter_period(tilt) for tilt in (1.0, -0.3)),
        lambda: rocking.solve(ROCKER, 1.0, 2.0),
    ],
    "motion": [
        lambda: solve_unilateral(make(motion=Motion((0.0, 1.0), (1e-6, 0.0), (0.0, 0.0))), CONSTANT, 1),
    ],
    "vertices": [lambda: solve(make(((0, 0), (2, 0), (3, 1), (2, 2), (0, 2)), top=3), CONSTANT, 1)],
    "edge": [
        lambda: PlaneModel([replace(BODY, clamps=(INSIDE,))]),
        lambda: PlaneModel([replace(BODY, tractions=((INSIDE, (1.0, 0.0)),))]),
        lambda: PlaneModel([BODY]).observer(*INSIDE),
        lambda: PlaneModel([BODY]).observer((0.1, 0.0), (0.9, 0.0)),
        lambda: PlaneModel([BODY], [replace(FLOOR, end=(2.0, 0.0))]),
    ],
    "load": [
        lambda: PlaneModel([replace(BODY, tractions=((UP, (1.0, 0.0)),))]).rest,
        lambda: PlaneModel([replace(BODY, gravity=(1.0, 0.0))], [FLOOR]).rest,
    ],
    "stress": [lambda: PlaneModel([BODY]).stress_error()],
    "polygons": [lambda: PlaneModel([replace(BODY, polygons=(HOOK,), rectangle=False)])],
    "contact": [lambda n=n: PlaneModel([BODY], [replace(FLOOR, first=n)]) for n in (-1, 1)],
    "rollers": [lambda: PlaneModel([replace(BODY, rollers=((UP, "z"),))])],
}  # fmt: skip

ASKED = {  # by the names and values of a row of `refusals.toml`
    "scheme": lambda **given: named_scheme(**{"step": 1e-3} | given),
    "motion": Motion,
    "map": lambda omega=1.0, theta=1.0, **given: restitution(
        ContactScheme(**{"alpha": 0.5, "delta": 1.0} | given), omega, theta
    ),
    "opening_bar": lambda **given: OpeningBar.of(make(**given)),
    "angle": Friction,
    "layer": lambda **given: Ground((replace(STRATA[0], **given),), "pressure"),
    "recorded": sliding_block.recorded,
    "moved": sliding_block.moved,
    "lines": lambda name: lines(columns=(name,)),
}


def maker(asked):
    return ASKED.get(asked) or partial(replace, SOUND[asked])


CASES = [(field, lambda t=t, change=change: replace(t, **change)) for t, field, change in TOGETHER]
for asked, refused in TABLE.items():
    for field, rows in refused.items():  # rows of what is given, or values of the field
        given = [row if isinstance(row, dict) else {field: row} for row in rows]
        CASES += [(field, partial(maker(asked), **one)) for one in given]
CASES += [(field, ask) for field, asks in ASKS.items() for ask in asks]


def test_what_cannot_be_is_refused_by_its_field():
    for number, (field, ask) in enumerate(CASES):
        try:
            ask()
        except ValueError as error:
            assert re.match(rf"{re.escape(field)}: \w", str(error)), (number, field)
        else:
            pytest.fail(f"case {number} of {field} is taken")


def test_what_is_just_within_its_bounds_is_taken():
    for asked, rows in TAKEN.items():
        for given in rows:
            maker(asked)(**given)
