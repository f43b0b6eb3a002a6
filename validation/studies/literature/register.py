"""The claims L1 to L10 of the register: what is measured for each."""

from __future__ import annotations

import math

import numpy as np

from validation.studies.claims import Evidence, Tests, named, whole
from validation.studies.literature import closed
from validation.theory import friction, soft_contact, spectra, statics
from validation.theory.one_mode import named as stages_of
from validation.theory.one_mode import newmark, rebounds
from validation.theory.stepping import Stepping
from validation.theory.waves import Column, base_reflection

SCENES = ("literature-sliding", "literature-rigid", "literature-locked", "literature-composite")
SLIDING = named("literature-sliding")
RIGID = named("literature-rigid")
LOCKED = named("literature-locked")
LOCKED_COMPOSITE = named("literature-composite")
CONSTANT = (0.5, 1.0)
AVERAGE = (0.25, 0.5)
SCHEMES = {"(1/2, 1)": CONSTANT, "(1/4, 1/2)": AVERAGE}
STEPS = (1e-4, 1e-3, 5e-3, 1e-2)  # s
STATIC_WORK = 5.0e4  # J: of the pressure on the paper's block over its own shortening, W0
ZETA = 0.05
MILLISECOND = 1e-3


def sliding(e: Evidence) -> dict[str, float]:
    """Return the error of a sliding block over p and dt, and what the runs leave of tan(phi) times normal motion."""
    scene = next(iter(SLIDING.values()))
    numbers: dict[str, float] = {}
    for p in (1e8, 1e9, 1e10):
        for step in STEPS:
            error = closed.normal_ringing_error(scene, p, step)
            numbers[f"error at p = {p:g}, dt = {1e3 * step:g} ms"] = error
    leftovers = []
    runs: dict[tuple[float, float], float] = {}
    for name, case in SLIDING.items():
        history = e.finished.needed_history(name, "dda")
        along = history.columns["horizontal_displacement"]
        acceleration = friction.sliding_acceleration(case)
        free, _ = friction.free_motion(case, acceleration)
        coupled = along + friction.coefficient(case) * history.columns["displacement"] - free
        leftovers.append(float(np.max(np.abs(coupled)) / free[-1]))
        way = acceleration * history.time**2 / 2
        late = history.time >= 0.05 - closed.TOLERANCE
        runs[case.contact.stiffness, case.time.step] = float(np.max(np.abs(along / way - 1)[late]))
    for p in (1e9, 1e10, 1e12, 1e14):
        numbers[f"error as run at p = {p:g}, dt = 1 ms"] = runs[p, MILLISECOND]
    gains = [
        numbers[f"error at p = {p:g}, dt = 0.1 ms"] / numbers[f"error at p = {p:g}, dt = 10 ms"] for p in (1e8, 1e9)
    ]
    return numbers | {
        "gain by a step 100 times as long": max(gains),
        "error as run at p = 1e+12 over that at 1e+10": runs[1e12, MILLISECOND] / runs[1e10, MILLISECOND],
        "tan(phi) x normal motion leaves": max(leftovers),
        **{
            f"error at 1 s, friction of the step before, dt = {1e3 * step:g} ms": closed.lagging_friction_error(
                scene, step, 1.0
            )
            for step in STEPS
        },
    }


def impacts(e: Evidence) -> dict[str, float]:
    """Return mean rebounds over W, and the greatest and the energy of average acceleration in the stiff limit."""
    numbers: dict[str, float] = {}
    for omega in (0.1, 0.3, 1.0):
        numbers[f"forward Euler at W = {omega:g}"] = float(closed.explicit_rebounds(omega, symplectic=False).mean())
        numbers[f"symplectic Euler at W = {omega:g}"] = float(closed.explicit_rebounds(omega, symplectic=True).mean())
        for name, scheme in SCHEMES.items():
            numbers[f"{name} at W = {omega:g}"] = float(rebounds(newmark(*scheme), omega).mean())
    stiff = rebounds(newmark(*AVERAGE), 1e5, phases=2000)
    return numbers | {
        "(1/4, 1/2), greatest at any W": float(stiff.max()),
        "(1/4, 1/2), energy of a stiff contact": float(np.mean(stiff**2)),
    }


def composite(e: Evidence) -> dict[str, float]:
    """Return the error of a free mass under a sine, that of the locked block, and the contact mode's damping."""
    sine = {
        "(1/2, 1)": closed.newmark_on_sine(*CONSTANT),
        "(1/4, 1/2)": closed.newmark_on_sine(*AVERAGE),
        "composite": closed.composite_on_sine(0.5),
    }
    numbers = {f"free mass, dt = 0.05 s, {name}": closed.forced_mass_error(step, 0.05) for name, step in sine.items()}
    for cases in (LOCKED, LOCKED_COMPOSITE):
        for name, case in cases.items():
            history = e.finished.needed_history(name, "dda")
            exact = closed.exact_locked(case, history.time)
            scheme = "composite" if case.time.scheme == "composite" else f"delta = {case.time.delta:g}"
            error = np.max(np.abs(history.displacement - exact)) / np.max(np.abs(exact))
            numbers[f"locked block, dt = {1e3 * case.time.step:g} ms, {scheme}"] = float(error)
    stiff = next(iter(LOCKED.values())).with_values({"contact.stiffness": 1e11})
    omega = spectra.contact_frequency(stiff) * 1e-2
    bathe = Stepping.named("composite", 1e-2, rho_inf=0.0, split=0.5)
    numbers["contact mode at p = 100E, dt = 10 ms, xi of the composite"] = bathe.damping_ratio(omega)
    numbers["contact mode at p = 100E, dt = 10 ms, |lambda| of (1/2, 1)"] = Stepping(1e-2).spectral_radius(omega)
    impact = rebounds(stages_of("composite", 0.0, 0.5), 1e5, phases=2000)
    return numbers | {
        "error at equal solves over that of (1/4, 1/2)": numbers["locked block, dt = 1 ms, composite"]
        / numbers["locked block, dt = 0.5 ms, delta = 0.5"],
        "greatest rebound of a stiff contact": float(impact.max()),
    }


def dashpots(e: Evidence) -> dict[str, float]:
    """Return the damping of one mode with a dashpot over W, and of the block with one at its contact."""
    unit = np.eye(1)
    numbers: dict[str, float] = {}
    changes: dict[str, float] = {}
    for name, (alpha, delta) in SCHEMES.items():
        ratios = []
        for omega in (0.01, 0.1, 0.3, 1.0, 3.0):
            stepping = Stepping(omega, alpha, delta)
            ratios.append(float(closed.damped_roots(stepping, unit, 2 * ZETA * unit, unit)[0]))
            numbers[f"{name}, W = {omega:g}"] = ratios[-1]
        changes[f"{name}, change to W = 0.3"] = abs(ratios[2] / ZETA - 1)
    block = next(iter(LOCKED.values()))
    for p, word in ((1e9, "1E"), (1e11, "100E")):
        case = block.with_values({"contact.stiffness": p})
        mass, stiffness, gap = closed.two_unknowns(case)
        c = 2 * ZETA * math.sqrt(2 * p * soft_contact.QUARTER * case.block.mass)
        damping = c * np.outer(gap, gap)
        for number, value in enumerate(closed.exact_damped_roots(mass, damping, stiffness), start=1):
            numbers[f"exact xi of mode {number}, p = {word}"] = float(value)
        if p == 1e9:
            stepped = closed.damped_roots(Stepping(MILLISECOND), mass, damping, stiffness)
            for number, value in enumerate(stepped, start=1):
                numbers[f"(1/2, 1) at 1 ms, xi of mode {number}, p = {word}"] = float(value)
    return numbers | changes


def augmented(e: Evidence) -> dict[str, float]:
    """Return the passes of the augmented Lagrangian, and what rigid contact in displacements does in impacts."""
    block = next(iter(RIGID.values()))
    width, height = statics.size(block)
    modulus, _ = statics.moduli(block)
    m = block.block.mass
    numbers: dict[str, float] = {}
    for step in (1e-2, 2e-3, 1e-3, 1e-4):
        weight = CONSTANT[0] * step**2
        strain = m * height**2 / 12 + weight * modulus * width * height
        compliance = weight * (1 / m + (height / 2) ** 2 / strain)
        product = 2 * modulus * compliance  # r = 2 p at p = 1E
        numbers[f"r C at p = 1E, dt = {1e3 * step:g} ms"] = product
        passes = math.ceil(math.log(1e6) / math.log1p(product))
        numbers[f"passes to 1e-6 of the penetration, p = 1E, dt = {1e3 * step:g} ms"] = whole(passes)
    return numbers | rigid_stop(e)


def rigid_stop(e: Evidence) -> dict[str, float]:
    """Return peak pressure and energy gained on a rigid stop in displacements, and its rebounds at every step."""
    numbers: dict[str, float] = {}
    for name, case in RIGID.items():
        scheme = f"delta = {case.time.delta:g}, dt = {1e3 * case.time.step:g} ms"
        energy = sum(e.number(name, f"energy.{part}") for part in ("kinetic", "strain", "springs", "load"))
        numbers[f"energy gained at 0.1 s over W0, {scheme}"] = energy / STATIC_WORK
        pressure = e.finished.needed_history(name, "dda").contact_pressure
        numbers[f"peak pressure, {scheme}, MPa"] = float(pressure.max()) / 1e6
    numbers["most solves of a step"] = whole(max(e.number(name, "contact.most_solves") for name in RIGID))
    numbers["greatest penetration, m"] = max(e.number(name, "contact.penetration") for name in RIGID)
    for word, scheme in SCHEMES.items():
        values = rebounds(newmark(*scheme), 1e6, phases=2000)
        numbers[f"mean rebound at every step, {word}"] = float(values.mean())
        numbers[f"least rebound, {word}"] = float(values.min())
        numbers[f"greatest rebound, {word}"] = float(values.max())
    return numbers


def kinetic_damping(e: Evidence) -> dict[str, float]:
    """Return rate and damping ratios of gg = 0.98 over dt, and the way that a shaken block keeps."""
    gg = 0.98
    numbers = {f"rate at dt = {1e3 * step:g} ms, 1/s": -math.log(gg) / step for step in (1e-2, 5e-3, 2.5e-3, 1e-3)}
    for step in (1e-2, 2.5e-3):
        for hertz in (1.0, 5.0, 10.0):
            xi = Stepping(step, *AVERAGE, gg=gg).damping_ratio(2 * math.pi * hertz * step)
            numbers[f"xi at {hertz:g} Hz, dt = {1e3 * step:g} ms"] = xi
    ratios = [numbers[f"xi at {hertz:g} Hz, dt = {1e3 * step:g} ms"] for hertz, step in ((1, 2.5e-3), (10, 1e-2))]
    numbers["greatest xi over least"] = max(ratios) / min(ratios)
    numbers["frequency of 2 % times dt"] = -math.log(gg) / (2 * 0.02) / (2 * math.pi)
    exact = closed.shaken_way(closed.FINE, 1.0)
    for step in (1e-2, 5e-3, 2.5e-3, 1e-3, 1e-4):
        numbers[f"way kept at dt = {1e3 * step:g} ms"] = closed.shaken_way(step, gg) / exact
    numbers["way without a discount at dt = 10 ms"] = closed.shaken_way(1e-2, 1.0) / exact
    return numbers


def viscous_base(e: Evidence) -> dict[str, float]:
    """Return |R| of a discrete base over blocks a wavelength and Courant number, and energy back at oblique incidence."""
    numbers: dict[str, float] = {}
    block = Column(height=1.0, density=1.0, modulus=1.0)  # so that c = 1
    for blocks in (10, 20):
        omega = 2 * math.pi / blocks
        for name, scheme in SCHEMES.items():
            for courant in (0.1, 0.5, 1.0):
                reflected = base_reflection(block, Stepping(courant, *scheme), omega, impedance=1.0)
                numbers[f"|R|, {blocks} blocks a wave, {name}, c dt/h = {courant:g}"] = float(np.abs(reflected))
    for wave in ("P", "S"):
        for angle in (0.0, 30.0, 45.0, 60.0, 75.0):
            numbers[f"energy back of {wave} at {angle:g} deg"] = closed.returned_energy(angle, wave)
    return numbers


TESTS: Tests = {
    "L1": (SLIDING, sliding),
    "L2": ((), impacts),
    "L3": ((*LOCKED, *LOCKED_COMPOSITE), composite),
    "L4": ((), dashpots),
    "L5": (RIGID, augmented),
    "L6": (RIGID, rigid_stop),
    "L9": ((), kinetic_damping),
    "L10": ((), viscous_base),
}
