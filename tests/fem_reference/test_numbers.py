"""Motions at odd numbers are what they were: `numbers.txt`, at eight digits. `KEEP_PAGES=1` writes it anew."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.elements import INCLINED, make
from oracles.kept_numbers import hold

from fem_reference import (
    COLUMNS,
    Friction,
    Motion,
    PatchContact,
    PlaneBody,
    PlaneModel,
    Scheme,
    Unilateral,
    modes,
    named_scheme,
    solve,
    solve_unilateral,
)
from fem_reference.column.contact_model import ColumnContact, ContactColumn
from fem_reference.column.contacts import solve_contacts
from fem_reference.column.problem import Excitation, Ground, Stratum
from fem_reference.column.stepping import highest_frequency, solve_line
from fem_reference.column.vibration import line_response
from fem_reference.contact.columns import LOSS_COLUMNS
from fem_reference.events import bar_events, bars_events, block_events, column_drive, column_events
from fem_reference.events.bars_model import Bar as WaveBar
from fem_reference.events.bars_model import BarJoint, BarsProblem
from fem_reference.events.block_model import BlockProblem
from fem_reference.events.column_model import ColumnBlock, ColumnJoint, ColumnProblem
from fem_reference.events.restitution import ContactScheme, branches, statistics
from fem_reference.events.switches import Work
from fem_reference.exact import layers, rocking, sliding_block
from fem_reference.exact.bar import Bar
from fem_reference.exact.opening_bar import OpeningBar
from fem_reference.exact.vibration import response as bar_response
from fem_reference.history.response import response
from fem_reference.mesh.model import build
from fem_reference.problem.bar import BarProblem
from fem_reference.scheme.diagnostics import diagnostics

KEPT = Path(__file__).with_name("numbers.txt")
SHAKE = Motion((0.0, 0.004, 0.011, 0.03), (0.0, 1e-3, -2e-3, 0.0), (0.0, -5e-4, 1e-3, 0.0))
SLANTED = make(INCLINED, 1, 3, 0.3, "plane strain", 7e8, 4e8, elements=2, degree=1, traction=2e5, gravity=9.81)
DAMPED = Scheme(0.45, 0.65, 0.97, 1.3e-3)
VISCOUS = replace(DAMPED, mass_damping=7.0, stiffness_damping=3e-4)
COMPOSITE = named_scheme("composite", step=1.3e-3, gg=0.97, rho_inf=0.4, split=0.3)
LEAPFROG = named_scheme("leapfrog", step=5e-4, gg=0.97)
ALPHA = named_scheme("chung-hulbert", step=1.3e-3, gg=0.97, rho_inf=0.6)
STRATA = (Stratum(1.3, 2100.0, 3e8, 0.25), Stratum(0.7, 2500.0, 9e8, 0.1))


def ends(columns):
    """Return sums of columns, of which the last rows count most, but what is rounding of their parts."""
    sums = [(values * np.linspace(0.3, 1.0, len(values)) ** 2).sum() for values in columns.values()]
    return [x * (abs(x) > 1e-9 * np.sum(np.abs(values))) for x, values in zip(sums, columns.values(), strict=True)]


def reached(result):
    """The last row of a result, its instant and what it has cost."""
    return ends(result.columns), result.time[-1], result.unknowns, result.factorisations, result.solves


def fields(history):
    return [values for name, values in vars(history).items() if "radius" not in name and name != "time"]


def element_numbers():
    on_patches = make(poisson=0.2, elements=2, gravity=3.7, foundation="patch", patch_width=0.3)
    for problem, schemes in ((SLANTED, (DAMPED, COMPOSITE, ALPHA, LEAPFROG)), (on_patches, (COMPOSITE, VISCOUS))):
        model = build(problem)
        for scheme in schemes:
            found = diagnostics(problem, scheme, model=model)
            yield "step", found.condition_number, found.spectral_radius, found.predicted_radius, found.largest_omega
            yield "history", reached(solve(problem, scheme, 7, COLUMNS, model=model))
            yield "response", response(problem, scheme, [37.0], COLUMNS, model=model)
        yield "mode", *(mode.frequency for mode in modes(problem, ALPHA, model=model)[:2])
    moved = replace(SLANTED, motion=SHAKE)
    yield "moved", ends(solve(moved, DAMPED, 7, COLUMNS).columns)
    yield "moving", response(moved, DAMPED, [37.0], COLUMNS, along=(0.3, 0.7))
    for course in (SHAKE, replace(SHAKE, y=(0.0,) * 4), None):
        unloaded = replace(moved, pressure=0.0, traction=0.0, gravity=0.0, motion=course)
        yield "carried", *((mode.frequency, mode.share) for mode in modes(unloaded, ALPHA)[:2])
    yield "idle", response(unloaded, ALPHA, [37.0])
    yield "pressed", [make(base=b, top=t, eccentricity=0.3).pressed for b, t in ((2, 0), (0, 1), (0, 3))]
    yield "ramp", ends(solve(make(elements=2, ramp=0.004), ALPHA, 7).columns)


def shaking(scheme):
    t = scheme.stage_times(60)
    moved = 2e-4 * np.sin(90 * t) ** 2, 0.018 * np.sin(180 * t), 3.24 * np.cos(180 * t)
    return Excitation(*moved, 2e4 * np.sin(70 * t))


def contact_numbers():
    rough = Friction(17.0, 1e4)
    shaken = replace(SLANTED, motion=SHAKE, slope=11.0)
    slides = Unilateral(1e-3, -0.3, "glued", friction=rough)
    curved = replace(shaken, degree=2)
    for problem, scheme, contact in (
        (shaken, DAMPED, slides),
        (shaken, COMPOSITE, slides),
        (curved, ALPHA, slides),
        (shaken, ALPHA, Unilateral(0.0, 0.2)),
    ):
        yield "opens", reached(solve_unilateral(problem, scheme, 25, contact))
    yield "flies", ends(solve_unilateral(shaken, DAMPED, 3, Unilateral(2e-2, 0.3)).columns)
    implicit = Unilateral(1e-3, -0.3, rule="implicit")
    yield "implicit", ends(solve_unilateral(make(elements=2), Scheme(0.25, 0.5, 0.97, 1e-3), 25, implicit).columns)
    for columns in (LOSS_COLUMNS, ("load_energy",), ("strain_energy",), ("displacement",)):
        few = solve_unilateral(shaken, DAMPED, 9, Unilateral(shear="glued", friction=rough), columns=columns)
        yield "few", ends(few.columns)
    for elements, degree in ((4, 2), (7, 1)):  # more points than all sets of states are tried of, and as many
        many = make(shear=4e8, eccentricity=0.6, poisson=0.2, elements=elements, degree=degree)
        yield "solves", solve_unilateral(many, DAMPED, 9, Unilateral(1e-4, -2.0, "glued", limit=1)).columns["solves"]
    names = ("displacement", "contact_pressure", "velocity_1", "stress_1")
    for law, scheme, levels, impedance, stiffness in (
        ("unilateral", ALPHA, (0.0, 1.3), None, 3e9),
        ("frictional", COMPOSITE, (0.0, 1.3), None, 3e9),
        ("unilateral", ALPHA, (1.3,), None, math.inf),
        ("frictional", ALPHA, (1.3,), 5e5, math.inf),
        ("unilateral", ALPHA, (0.0, 1.3), None, math.inf),
    ):
        opens = law == "unilateral"
        ground = Ground(STRATA, "pressure" if opens else "shear", impedance=impedance)
        limits = (1e-4 * (stiffness < math.inf),) if opens else (0.0, 7e3)
        faces = tuple(ColumnContact(height, stiffness, *limits) for height in levels)
        column = ContactColumn(ground, law, faces, (0.2, -0.1), 9.81 * opens)
        of_contact = "force_1", "gap_1", "slip_1"
        found = solve_contacts(column, [2, 1], 2, scheme, shaking(scheme), (*names, *of_contact), [1.3])
        yield law, ends(found.columns), found.openings[:, -1], found.states[:, -1], found.mean_velocity[-1]
    welded = replace(column, contacts=faces[1:])
    yield "welded", reached(solve_contacts(welded, [2, 1], 2, ALPHA, shaking(ALPHA), (*names, "force_1"), [1.3]))
    for scheme, impedance in ((ALPHA, None), (COMPOSITE, 5e5)):
        ground = Ground(STRATA, "shear", ((0.6, 4e8),), impedance)
        on_joint = replace(ground, joints=((0.0, 3e8), *ground.joints))
        yield "fastest", *(highest_frequency(one, [2, 1], 2) for one in (ground, on_joint))
        yield "line", reached(solve_line(ground, [2, 1], 2, scheme, shaking(scheme), names[:2]))
        for at_top in (False, True):
            yield "vibrates", line_response(ground, [2, 1], 2, scheme, [13.0], at_top, names[:2])
            yield "layers", layers.amplitudes(ground, [80.0, 400.0], names[:2], [])[at_top]


def exact_numbers():
    problem = make(p=3e8, ramp=0.004)
    yield "bar", reached(Bar.of(problem).solve(ALPHA, 30)), bar_response(Bar.of(problem), ALPHA, [37.0])
    for scheme in (DAMPED, VISCOUS):
        yield "continuum", reached(Bar.of(make(p=3e8)).continuum(scheme, 20))
    yield "opens", reached(OpeningBar.of(make(), gap=1e-3, velocity=-0.3).solve(DAMPED, 60))
    rocks = rocking.solve(rocking.RockingBlock(0.7, 1.9, 3.7, 0.8), 4.0, 0.2)
    yield "rocks", rocks.impacts[:4], rocks.at([1.7])
    for base, values in (sliding_block.recorded, [1, -9, 12, 0]), (sliding_block.moved, [0.02, -0.2, 0.5, 0.1]):
        slides = sliding_block.solve(sliding_block.SlidingBlock(3, 17, 9.81, 0.2), base([0, 0.1, 0.4, 0.9], values), 2)
        yield "slides", slides.slip, slides.at([0.2, 0.6, 1.3]), slides.switches
    for omega in (0.7, 2.3, math.inf):
        scheme = ContactScheme(0.3, 0.65, 0.97)
        yield "impact", statistics(scheme, omega), branches(scheme, omega)[:2]


def course(motion):
    """Switches and steps, each as a number and a mean instant, and what stayed in doubt."""
    found = [switch.time for switch in motion.switches]
    steps = [float(node.start.time) for node in motion.nodes]
    return len(found), np.mean(found or [0.0]), len(steps), np.mean(steps), len(motion.simultaneous), motion.touches


def event_numbers():
    dropped = BarProblem(1.5, 0.7, 2400.0, 3e9, 4e9, 2e6, 9.81, 1e-4, -0.3)
    work = Work()
    yield "bar", fields(bar_events.solve(dropped, 0.01, work=work).at([0.0083])), work.terms
    block = BlockProblem(2.0, 1.5, 2700.0, 1e9, 1e9, 5e6, eccentricity=0.2, poisson=0.2, gravity=9.81)
    for end, changes in (
        (0.0083, {"damping": 2e6, "velocity": -0.4, "gap": 1e-3}),
        (
            0.0119,
            {"shear_stiffness": 4e8, "friction": 17.0, "cohesion": 1e3, "traction": 1e6, "slope": 11.0, "base": SHAKE},
        ),
        (0.0049, {"stiffness": math.inf, "restitution": 0.2, "eccentricity": 0.0}),
    ):
        motion = block_events.solve(replace(block, **changes), end)
        yield "block", fields(motion.at([end])), course(motion)
        for one in (*motion.impacts, *motion.cascades):
            yield "impact", [value for name, value in vars(one).items() if name != "radius"]
    yield "still", block_events.solve(replace(block, pressure=0.0, gravity=0.0), 1e-3).closed_at_start
    drive = column_drive.integrated(column_drive.ricker(0.5, 400.0))
    blocks = (ColumnBlock(1.3, 2500.0, 1e9, 0.1), ColumnBlock(0.7, 2200.0, math.inf, -0.2))
    opening = ColumnProblem(blocks, (ColumnJoint(1e9, 1e-4), ColumnJoint(3e9)), gravity=9.81, base_motion=drive)
    rough = tuple(ColumnJoint(1e9, strength=strength) for strength in (2e5, 1e5))
    rising = replace(opening, joints=rough, law="frictional", gravity=0.0)
    welded = replace(opening, joints=(None, ColumnJoint(3e9)), at_rest=True)
    bonded = replace(opening, joints=(None, None), base="free", pressure=column_drive.half_sine(1e5, 0.02))
    on_waves = replace(welded, base="transmitting", impedance=1e6, gravity=0.0, at_rest=False)
    for problem in (opening, rising, welded, on_waves, bonded):
        motion = column_events.solve(problem, 0.006)
        work = Work()
        motion = column_events.solve(problem, 0.006, work=work)
        history = motion.at([0.0055])
        yield "column", fields(history), history.gap, course(motion), work.terms
    bars = BarsProblem(
        (WaveBar(1.3, 1.0, 1.0, 0.3), WaveBar(0.7, 2.0, 3.0, -0.2)),
        (BarJoint("unilateral", 5.0, 0.1), BarJoint("unilateral", 7.0, 0.05)),
        gravity=0.05,
        base_impedance=0.7,
        top=column_drive.half_sine(0.3, 0.7),
    )
    slipping = BarJoint("frictional", 5.0, strength=0.12), BarJoint("frictional", strength=0.07)
    rubbing = replace(bars, joints=slipping, gravity=0.0, base=column_drive.sine(0.2, 0.4, 1))
    stops = BarJoint("unilateral"), bars.joints[1]
    resting = replace(bars, joints=stops, settled=True, base=column_drive.triangle(-0.4, 0.9), base_impedance=math.inf)
    for problem in (bars, rubbing, resting):
        work = Work()
        waves = bars_events.solve(problem, 2.9, work=work)
        times = [1.3, 2.85]
        yield "waves", fields(waves.at(times)), vars(waves.point(1, 0.3, times)), waves.impulse(1, times), work.terms
    yield "work", bars_events.least_terms(bars, 2.0), column_events.least_terms(rising, 0.006)


def plane_numbers():
    lower = (((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)),)
    upper = (((0.3, 1.01), (1.7, 1.01), (1.5, 1.8), (0.4, 2.0)),)
    bodies = [
        PlaneBody(lower, 2500.0, 1e9, 0.25, rectangle=True, gravity=(0.3, -9.81), spin=0.02, elements=1),
        PlaneBody(upper, 2300.0, 7e8, 0.3, velocity=(0.4, -6.0), hypothesis="plane strain", elements=1),
    ]
    law = {"stiffness": 1e9, "shear_stiffness": 5e8, "friction": 0.3}
    contacts = [PatchContact(0, None, (x, 0.0), (x + 0.5, 0.0), (0.0, 1.0), **law) for x in (0.0, 1.5)]
    contacts += [
        PatchContact(1, 0, (x, 1.01), (x + 0.4, 1.01), (0.0, 1.0), gap=0.01, cohesion=1e3, **law) for x in (0.3, 1.3)
    ]
    for scheme in (VISCOUS, COMPOSITE):
        model = PlaneModel(bodies, contacts, SHAKE)
        found = model.history(scheme, 30, np.vstack([model.means(0), model.observer((0.4, 2.0), (0.4, 2.0), 1)]))
        yield "meet", reached(found), ends(found.rates), ends(found.energy), found.step_solves.sum()
        yield "forces", *(part[-1] for part in (found.normal, found.shear, found.gap, found.slip, found.momentum))
    clamped = replace(bodies[0], clamps=(((0.0, 1.0), (0.0, 0.0)),), forces=(((2.0, 1.0), (3e5, -1e5)),), spin=0.0)
    pushed = replace(bodies[0], spin=0.0, forces=(((2.0, 1.0), (3e4, -4e4)),))
    rests = PlaneModel([pushed], contacts[:2])
    yield "rests", rests.settled.normal, rests.settled.shear, rests.means(0) @ rests.rest
    held = PlaneModel([replace(clamped, stress=(3e6, -1e6, 2e6))])
    yield "held", held.rest @ held.M @ held.rest, *(mode.share for mode in held.modes(DAMPED, 3))


PARTS = {
    part.__name__: part for part in (element_numbers, contact_numbers, exact_numbers, event_numbers, plane_numbers)
}


@pytest.mark.parametrize("part", PARTS)
@np.errstate(all="ignore")
def test_motions_are_what_they_were(part):
    hold(KEPT, PARTS, part)
