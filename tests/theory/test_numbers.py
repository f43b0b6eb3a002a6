"""Closed forms at odd numbers give what they gave: `numbers.txt`, at eight digits. `KEEP_PAGES=1` writes it anew."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from oracles.kept_numbers import hold

from validation import load_scene
from validation.theory import (
    boxes,
    columns,
    corner_impact,
    first_touch,
    friction,
    landing,
    overshoot,
    rebound,
    restitution,
    rocking,
    spectra,
    spinning,
    stages,
    statics,
    truss,
    vibration,
    waves,
    wedges,
)
from validation.theory.stepping import Stepping

KEPT = Path(__file__).with_name("numbers.txt")
OBLONG = {
    **{"block.width": 0.7, "block.height": 3.1, "block.density": 2300.0, "block.young": 6e8, "block.poisson": 0.2},
    **{"contact.stiffness": 4e8, "contact.shear_stiffness": 3e8, "load.pressure": 3e6, "load.gravity": 3.7},
    **{"time.step": 1.3e-3, "time.steps": 23, "time.gg": 0.97, "time.alpha": 0.3, "time.delta": 0.65},
}
SCHEMES = [
    *(Stepping(0.7, *numbers) for numbers in [(0.5, 1.0), (0.25, 0.5, 0.9), (0.3, 0.65, 0.97), (0.1, 0.6), (0.0, 0.5)]),
    *(Stepping.named(name, 0.7, 0.95, 0.6) for name in ("chung-hulbert", "hht", "wbz")),
    *(Stepping.named("composite", 0.7, gg, rho, split) for gg, rho, split in [(1.0, None, None), (0.9, 0.4, 0.3)]),
    Stepping.named("leapfrog", 0.7, 0.95),
]
CUBE = [(-0.5, -0.4), (0.6, -0.5), (0.1, 0.7)]


def scene(**values):
    return load_scene("figures-3-4").with_values(OBLONG | {k.replace("__", "."): v for k, v in values.items()})


def block_numbers():
    oblong = scene()
    strain = scene(block__hypothesis="plane strain", fem__elements=5, fem__degree=1)
    for one in (oblong, strain):
        names = "dda_frequency bar_frequency contact_frequency critical_omega remaining_motion mesh_frequency_error"
        for name in (*names.split(), "transit", "elements_per_front", "rounding"):
            yield name, getattr(spectra, name)(one)
        b = spectra.bar_modes(one, 3)
        yield "modes", b, *(spectra.bar_shares(one, name, b) for name in ("displacement", "pressure"))
        yield "response", spectra.bar_response(one, b)[-1], spectra.mesh_error(one)
        yield "mode", spectra.roots(one, 90.0), spectra.damping_ratio(one, 90.0), spectra.spectral_radius(one, 90.0)
        yield "static", statics.static_displacement(one), statics.moduli(one), statics.elasticity(6e8, 0.2)
    w2 = np.array([70.0, 310.0]) ** 2
    answers = [vibration.block(oblong, w2), vibration.block(oblong, w2, base=True), vibration.bar(oblong, w2)]
    for one in (*answers, vibration.elements(oblong, w2, 3)):
        yield "vibration", vars(one), one.band
    sloped = scene(contact__law="unilateral", contact__friction=20.0, contact__cohesion=4e3, load__slope=31.0)
    names = "settlement penalty_offset threshold_angle normal_frequency creep_scale lag ringing_decay drag_rate"
    for name in (*names.split(), "time_constant", "sliding_acceleration"):
        yield name, getattr(friction, name)(sloped)
    yield "creep", friction.damped_creep(sloped.with_values({"contact.friction": 40.0}))
    yield "rings", friction.ringing_decay(sloped.with_values({"time.scheme": "hht", "time.rho_inf": 0.6}))
    yield "free motion", [part[-1] for part in friction.free_motion(sloped, 1.7)], friction.distance_share(0.9, 0.1, 3)
    yield "rocking", vars(rocking.rectangle(sloped)), rocking.settlement(sloped)


def landing_numbers():
    drop = load_scene("impact").expand()[0].with_values({"block.height": 2.7, "block.width": 1.3, "block.velocity": -1})
    yield "rigid stop", landing.rigid_stop()
    for ratio in (0.3, 3.0, 30.0):
        one = drop.with_values({"contact.stiffness": ratio * drop.block.young})
        yield "own", vars(landing.own_landing(2 * ratio)), landing.contact_frequency(one)
        force = landing.impact_force(one, -1.7)
        yield "force", force, landing.quarter_mass_force(one, -1.7), landing.springs_for(one, 1.3, 3e-3)
    implicit = Stepping(1.0, rate=0.3, implicit=True)
    for scheme in (Stepping(1.0, 0.5, 1.0, 0.99), Stepping(1.0, 0.275, 0.55, 0.6), implicit):
        for ratio, step in ((3.0, 0.07), (3.0, 0.8), (math.inf, 0.1)):
            if math.isfinite(ratio) or not scheme.implicit:
                stepped = landing.stepped_landing(scheme, ratio, step, 1.3)
                yield "stepped", vars(stepped), stepped.error
    for table in (stages.newmark(0.3, 0.65), stages.chung_hulbert(0.3), stages.composite(0.3), stages.hht(0.8)):
        yield "rise", overshoot.greatest_rise(table, [0.7, 3.1], [0.8, 0.2])
        for omega, zeta in ((0.7, 0.0), (2.3, 0.2), (math.inf, 0.0)):
            yield "rebounds", rebound.rebound_statistics(rebound.spring_steps(table, omega, zeta), 5)
    yield "conserving", rebound.rebounds(rebound.conserving_steps(2.3), rebound.midpoints(3))
    for zeta in (0.3, 1.0, 1.7):
        back = restitution.damping_ratio(zeta / 2)
        yield "dashpot", restitution.restitution(zeta), restitution.contact_time(zeta), back


def stepping_numbers():
    for one in SCHEMES:
        yield one.name, one.roots(0.9), one.critical_omega, one.order, one.spring_weight
        yield "turns", one.oscillates(0.9), one.damping_ratio(0.9), one.period_error(0.9), one.leading_damping(0.9)
        yield "does", one.spectral_radius(3.1), one.solves, one.damps, one.has_contact_forces, one.at(0.1).gg
        if one.scheme == "composite":
            yield "grows", one.composite.fourth, one.composite.growth(0.9j)
        else:
            yield "vibrates", one.squared_frequency([0.3, 1.7]), one.velocity_factor([0.3, 1.7]), one.rayleigh()


def wave_numbers():
    for column in (waves.Column(0.5, 2000.0, 1.8e9), waves.Column(0.5, 2000.0, 1.8e9, glue=9e9)):
        step = Stepping(3e-4, 0.3, 0.65, 0.99)
        w2 = np.array([700.0, 5300.0]) ** 2
        yield "wave", column.wavenumber(w2), column.travelled(step, [700.0, 2100.0], 30.0)
        yield "joint", waves.joint_in_column(column, w2, 3e9), waves.base_reflection(column, step, [700.0], 8e5)
    yield "continuum", waves.joint_transmission([0.4, 3.0])
    steps = columns.far_face_step(900.0, 0.7, 0.3), columns.ring_down(40.0, Stepping(2e-3, 0.3, 0.65, 0.99))
    yield (
        "column",
        columns.lowest_frequency(3e9, 2500.0, 3),
        columns.greatest_solves(4),
        columns.static_forces([3, 2, 1]),
        *steps,
    )


def box_numbers():
    for shaken in (boxes.ShakenBox(-0.03, 1.5, 0.2, 9.81), boxes.ShakenBox(0.2, 3.0, 0.05, 3.7)):
        yield "shaken", *(vars(piece) for piece in shaken.pieces(0.6)), shaken.slip(np.array([0.4, 1.1]))
    yield (
        "rigid",
        vars(boxes.ShakenBox(0.03, 1.5, 0.9, 9.81).pieces(1.0)[0]),
        boxes.sliding_acceleration(31.0, 17.0, 3.7),
    )
    spring = boxes.SpringImpact(1700.0, 4e5, 9.81, 1.3)
    yield "spring", spring.rate, spring.peak_force, spring.duration, spring.sinking(np.array([0.03, 0.11]))
    falling = corner_impact.FallingRectangle(1.1, 0.7, 900.0, (0.3, 1.4), 0.4, (3.3, -0.6), -0.8, 6.1)
    turning = dataclasses.replace(falling, spin=7.0)
    for body in (falling, turning):
        time, corner = body.landing(2.0)
        landed = body.flown(time)
        yield "landed", time, corner, vars(landed), vars(landed.rebounded(corner)), body.next_impact(0.1, 2.0)
        for mu, ps in ((None, 0.0), (0.04, 3e8), (0.3, 3e6), (0.3, 3e7), (2.0, 2e6)):
            yield "springs", vars(corner_impact.on_springs(body, 2e6, ps, mu, 2.0))
        yield "impulses", *(corner_impact.rigid_impulse(body, mu, 2.0) for mu in (0.04, 0.3, 2.0))
    on_corner = {"place": (0.3, math.hypot(0.55, 0.35)), "angle": math.atan2(0.55, 0.35), "velocity": (1.0, 0.0)}
    for changes in ({"velocity": (1.0, -0.6)}, {"velocity": (1.0, 0.6)}, on_corner, on_corner | {"spin": 7.0}):
        light = dataclasses.replace(falling, **({"gravity": 0.0, "spin": 0.0} | changes))
        yield "weightless", light.next_impact(0.1, 5.0) or 0.0
    still = first_touch.MovingPolygon(np.array(CUBE), (0.0, 0.0), (0.1, 0.0), 0.2)
    for at, speed in (((2.0, 0.3), -1.3), ((1.3, -3.0), 1.1), ((0.1, 2.7), -0.9)):
        moving = first_touch.MovingPolygon(np.array(CUBE), at, (speed * at[0] / 2, speed * at[1] / 3), -0.7)
        for touch in first_touch.first_touches(still, moving, 5.0, 0.3):
            yield "touch", vars(touch), first_touch.normals(still, moving, touch)
            corner = dataclasses.replace(touch, foot=1.0)
            yield "corners", first_touch.normals(still, moving, corner)


def plane_numbers():
    box = rocking.Rectangle(0.7, 1.9, 3.7)
    yield (
        "box",
        box.alpha,
        box.rate2,
        box.housner,
        box.critical_spin,
        box.greatest_rotation(0.4),
        box.fall_time(0.2, 1.1),
    )
    yield "rocks", box.quarter_period(0.2), box.landing_rate(0.2), box.squared_rate(0.2, 0.8), box.pulse_threshold(0.6)
    yield "pulse", box.pulse_end(0.6, 0.3), box.pulse_peak(0.5, 0.3), box.pulse_overturning(1.2, 0.7)
    spun = spinning.Spinning(1.3, 0.7, 2100.0, 4e6, 0.3, 11.0)
    yield "spun", spun.at(np.linspace(0.0, 0.3, 4)), spun.momentum, spun.steady_strain
    for slide in (spinning.Slide(1.3, 0.7, 0.2, -0.6, 2.1), spinning.Slide(1.3, 0.7, 0.2, -0.6, 0.7, 3.7)):
        yield "slide", slide.stopping_distance, slide.tips or 0.0, slide.turn(0.6)
    half = truss.HalfTruss(2.1, 0.4, 700.0, 0.05, (0.001, 0.002), 2.09, 3e7, 5e7, 9.81)
    yield "truss", half.limit, half.rest(2e4), half.rest(1e9) is None, half.motion(np.array([0.01, 0.05]))
    pair = wedges.Wedges((900.0, 700.0), (0.7, 0.1), 0.3, 0.2, 9.81)
    yield "wedges", pair.motion(), pair.factor_of_safety


PARTS = {
    part.__name__: part
    for part in (block_numbers, landing_numbers, stepping_numbers, wave_numbers, box_numbers, plane_numbers)
}


@pytest.mark.parametrize("part", PARTS)
@np.errstate(all="ignore")
def test_closed_forms_give_what_they_gave(part):
    hold(KEPT, PARTS, part)
