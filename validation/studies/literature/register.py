"""The claims L1 to L10 of the register: what is measured for each."""

from __future__ import annotations

import math

import numpy as np

from validation.studies.claims import Evidence, Tests, named, whole
from validation.studies.literature import closed
from validation.theory import friction, soft_contact, spectra, statics
from validation.theory.rebound import ReboundStatistics, rebound_statistics, spring_steps
from validation.theory.stages import EXPLICIT_EULER, LEAPFROG, Stages
from validation.theory.stepping import Stepping
from validation.theory.waves import Column, base_reflection

SCENES = tuple(
    f"literature-{part}"
    for part in ("sliding", "rigid", "locked", "composite", "unlocked", "explicit", "alpha", "augmented")
)
SLIDING = named("literature-sliding")
RIGID = named("literature-rigid")
LOCKED = named("literature-locked")
LOCKED_COMPOSITE = named("literature-composite")
UNLOCKED = named("literature-unlocked")
EXPLICIT = named("literature-explicit")
ALPHA = named("literature-alpha")
AUGMENTED = next(iter(named("literature-augmented")))
CONSTANT = (0.5, 1.0)
AVERAGE = (0.25, 0.5)
SCHEMES = {"(1/2, 1)": CONSTANT, "(1/4, 1/2)": AVERAGE}
STEPS = (1e-4, 1e-3, 5e-3, 1e-2)  # s
STATIC_WORK = 5.0e4  # J: of the pressure on the paper's block over its own shortening, W0
STIFF = 1e5  # W that stands for infinity: rebounds are those of its limit to five digits
STIFFNESSES = {1e9: "1E", 1e10: "10E", 1e11: "100E"}  # N/m
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


def rebound(stages: Stages, omega: float, phases: int = 200) -> ReboundStatistics:
    """Return the statistics of the rebound of a rigid mass; infinite W is a rigid stop."""
    return rebound_statistics(spring_steps(stages, omega), count=phases)


def impacts(e: Evidence) -> dict[str, float]:
    """Return mean rebounds over W, and the greatest and the energy of average acceleration in the stiff limit."""
    stages = {"forward Euler": EXPLICIT_EULER, "symplectic Euler": LEAPFROG}
    stages |= {name: Stepping(1.0, *scheme).stages for name, scheme in SCHEMES.items()}
    numbers: dict[str, float] = {}
    for name, scheme in stages.items():
        for omega in (0.1, 0.3, 1.0):
            numbers[f"{name} at W = {omega:g}"] = rebound(scheme, omega).mean
    stiff = rebound(stages["(1/4, 1/2)"], STIFF, phases=2000)
    return numbers | {
        "(1/4, 1/2), greatest at any W": stiff.most,
        "(1/4, 1/2), energy of a stiff contact": stiff.mean_square,
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
    return numbers | {
        "error at equal solves over that of (1/4, 1/2)": numbers["locked block, dt = 1 ms, composite"]
        / numbers["locked block, dt = 0.5 ms, delta = 0.5"],
        "greatest rebound of a stiff contact": rebound(bathe.stages, STIFF, phases=2000).most,
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
    """Return the passes of the augmented Lagrangian, a run to rest, and what its limit does in impacts."""
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
    last = e.finished.needed_history(AUGMENTED, "dda").displacement[-1]
    strain = block.load.pressure * height / (2 * modulus)
    at_rest = {
        "displacement at rest, mm": 1e3 * float(last),
        "penetration left in it, nm": -1e9 * (float(last) + strain),
        "greatest penetration of the passes, nm": 1e9 * e.number(AUGMENTED, "contact.penetration"),
        "mean solves of a step, dt = 1 ms": e.number(AUGMENTED, "contact.mean_solves"),
    }
    return numbers | at_rest | rigid_stop(e)


def gained(e: Evidence, case: str) -> float:
    """Return the energy at the end over W0; at the start it is 0."""
    return sum(e.number(case, f"energy.{part}") for part in ("kinetic", "strain", "springs", "load")) / STATIC_WORK


def rigid_stop(e: Evidence) -> dict[str, float]:
    """Return peak pressure and energy gained on a rigid stop in displacements, and its rebounds at every step."""
    numbers: dict[str, float] = {}
    for name, case in RIGID.items():
        values = f"delta = {case.time.delta:g}, dt = {1e3 * case.time.step:g} ms"
        numbers[f"energy gained at 0.1 s over W0, {values}"] = gained(e, name)
        pressure = e.finished.needed_history(name, "dda").contact_pressure
        numbers[f"peak pressure, {values}, MPa"] = float(pressure.max()) / 1e6
    numbers["most solves of a step"] = whole(max(e.number(name, "contact.most_solves") for name in RIGID))
    numbers["greatest penetration, m"] = max(e.number(name, "contact.penetration") for name in RIGID)
    for word, scheme in SCHEMES.items():
        stop = rebound(Stepping(1.0, *scheme).stages, math.inf, phases=2000)
        numbers[f"mean rebound at every step, {word}"] = stop.mean
        numbers[f"least rebound, {word}"] = stop.least
        numbers[f"greatest rebound, {word}"] = stop.most
    return numbers


def explicit(e: Evidence) -> dict[str, float]:
    """Return limits and solves of the leapfrog, and its error beside Newmark's schemes where contact opens."""
    numbers: dict[str, float] = {"solves of a step": whole(Stepping.named("leapfrog").solves)}
    block = next(iter(UNLOCKED.values()))
    for stiffness, word in STIFFNESSES.items():
        omega = spectra.contact_frequency(block.with_values({"contact.stiffness": stiffness}))
        numbers[f"limit of the step at p = {word}, ms"] = 1e3 * Stepping.named("leapfrog").critical_omega / omega
    for cases in (EXPLICIT, UNLOCKED):
        for name, case in cases.items():
            if case.time.step == 2e-4:
                scheme = "leapfrog" if case.time.scheme == "leapfrog" else f"delta = {case.time.delta:g}"
                p = STIFFNESSES[case.contact.stiffness]
                numbers[f"error, p = {p}, dt = 0.2 ms, {scheme}"] = error(e, name)
                if scheme == "leapfrog":
                    numbers[f"energy gained at 0.1 s over W0, p = {STIFFNESSES[case.contact.stiffness]}"] = gained(
                        e, name
                    )
    return numbers | {
        f"error over that of (1/4, 1/2), p = {word}": numbers[f"error, p = {word}, dt = 0.2 ms, leapfrog"]
        / numbers[f"error, p = {word}, dt = 0.2 ms, delta = 0.5"]
        for word in ("1E", "100E")
    }


def error(e: Evidence, case: str) -> float:
    """Return the relative L2 error of the displacement of the centroid over 0.05 s, against the exact motion."""
    history, exact = (e.finished.needed_history(case, solver) for solver in ("dda", "block-events"))
    within = history.time <= 0.05 + closed.TOLERANCE
    difference = (history.displacement - exact.displacement)[within]
    return float(np.linalg.norm(difference) / np.linalg.norm(exact.displacement[within]))


def generalised_alpha(e: Evidence) -> dict[str, float]:
    """Return damping of the locked block's modes at p = 100E and 1 ms, and the energy gained where contact opens."""
    stiff = next(iter(ALPHA.values()))
    modes = {"first mode": spectra.dda_frequency(stiff), "contact mode": spectra.contact_frequency(stiff)}
    schemes = {"(1/2, 1)": Stepping(MILLISECOND)}
    for radius in (0.8, 0.5, 0.0):
        schemes[f"CH {radius:g}"] = Stepping.named("chung-hulbert", MILLISECOND, rho_inf=radius)
    numbers: dict[str, float] = {}
    for name, stepping in schemes.items():
        for mode, omega in modes.items():
            W = omega * MILLISECOND
            if stepping.oscillates(W):
                numbers[f"xi of the {mode}, {name}"] = stepping.damping_ratio(W)
            numbers[f"|lambda| of the {mode}, {name}"] = stepping.spectral_radius(W)
    for case, scene in ALPHA.items():
        numbers[f"energy gained at 0.1 s over W0, CH {scene.time.rho_inf or 0.0:g}"] = gained(e, case)
    for case, scene in UNLOCKED.items():
        if scene.time.step == MILLISECOND:
            numbers[f"energy gained at 0.1 s over W0, delta = {scene.time.delta:g}"] = gained(e, case)
    for radius in (0.8, 0.5, 0.2, 0.0):
        stages = Stepping.named("chung-hulbert", rho_inf=radius).stages
        numbers[f"greatest rebound of a stiff contact, CH {radius:g}"] = rebound(stages, STIFF, phases=2000).most
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
    """Return |R| of a base over blocks a wavelength and Courant number, and energy back at oblique incidence."""
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
    "L5": ((AUGMENTED, *RIGID), augmented),
    "L6": (RIGID, rigid_stop),
    "L7": ([(name, solver) for name in (*EXPLICIT, *UNLOCKED) for solver in ("dda", "block-events")], explicit),
    "L8": ((*ALPHA, *UNLOCKED), generalised_alpha),
    "L9": ((), kinetic_damping),
    "L10": ((), viscous_base),
}
