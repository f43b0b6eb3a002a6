"""What is said of cures for DDA, as numbers: impacts, dashpots, passes, the explicit scheme."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping

import numpy as np

from validation.engine.finished import Derived, DerivedRows, Finished
from validation.runs.row import Metrics
from validation.scenes.scene import Scene, load_scene
from validation.studies.methods import closed
from validation.theory import spectra, statics
from validation.theory.rebound import rebound_statistics, spring_steps
from validation.theory.stages import EXPLICIT_EULER, LEAPFROG
from validation.theory.stepping import Stepping

FACTS = "methods-facts"  # owner of the rows
AUGMENTED = "methods-augmented"
SCHEMES = {"(1/2, 1)": (0.5, 1.0), "(1/4, 1/2)": (0.25, 0.5)}
STIFF = 1e5  # W that stands for infinity: rebounds are those of its limit to five digits
ZETA = 0.05  # of a dashpot
QUARTER = 0.25  # effective over whole mass at the base of a block of one strain on springs much stiffer than itself
MILLISECOND = 1e-3  # s


def paper_block(stiffness: float = 1e9) -> Scene:
    """Return the paper's block on springs of a stiffness [N/m]."""
    return load_scene("figures-3-4").with_values({"contact.stiffness": stiffness, "time.step": MILLISECOND})


def impacts(finished: Finished) -> Metrics:
    """Return the mean rebound of a rigid mass on a spring over the phase of landing, W = w_c dt."""
    stages = {"forward Euler": EXPLICIT_EULER, "symplectic Euler": LEAPFROG}
    stages |= {name: Stepping(1.0, *scheme).stages for name, scheme in SCHEMES.items()}
    numbers = {}
    for name, scheme in stages.items():
        for omega in (0.1, 0.3, 1.0):
            numbers[f"{name} at W = {omega:g}"] = rebound_statistics(spring_steps(scheme, omega), count=200).mean
    stiff = rebound_statistics(spring_steps(stages["(1/4, 1/2)"], STIFF), count=2000)
    return numbers | {"(1/4, 1/2), greatest at any W": stiff.most}


def dashpots(finished: Finished) -> Metrics:
    """Return the damping ratio of one mode with a dashpot over W, and of the block with one at its contact."""
    unit = np.eye(1)
    numbers = {}
    for name, (alpha, delta) in SCHEMES.items():
        for omega in (0.01, 0.1, 0.3, 1.0, 3.0):
            ratios = closed.damped_roots(Stepping(omega, alpha, delta), unit, 2 * ZETA * unit, unit)
            numbers[f"{name}, W = {omega:g}"] = float(ratios[0])
    for stiffness, word in ((1e9, "1E"), (1e11, "100E")):
        block = paper_block(stiffness)
        mass, springs, gap = closed.two_unknowns(block)
        c = 2 * ZETA * math.sqrt(2 * stiffness * QUARTER * block.block.mass)
        damping = c * np.outer(gap, gap)
        solved = {f"exact, p = {word}": closed.exact_damped_roots(mass, damping, springs)}
        if word == "1E":
            solved["(1/2, 1) at 1 ms, p = 1E"] = closed.damped_roots(Stepping(MILLISECOND), mass, damping, springs)
        for name, ratios in solved.items():
            for number, ratio in enumerate(ratios, start=1):
                numbers[f"{name}, mode {number}"] = float(ratio)
    return numbers


def passes(finished: Finished) -> Metrics:
    """Return r C of a pass of the augmented Lagrangian at p = 1E, and the passes to 1e-6 of the penetration.

    A pass leaves 1/(1 + r C) of the penetration, with r = 2 p and C the compliance of a step at the base.
    """
    block = paper_block()
    width, height = statics.size(block)
    modulus, _ = statics.moduli(block)
    m = block.block.mass
    numbers = {}
    for step in (1e-2, 2e-3, 1e-3, 1e-4):
        weight = 0.5 * step**2
        strain = m * height**2 / 12 + weight * modulus * width * height
        product = 2 * modulus * weight * (1 / m + (height / 2) ** 2 / strain)
        numbers[f"r C, dt = {1e3 * step:g} ms"] = product
        numbers[f"passes, dt = {1e3 * step:g} ms"] = math.ceil(math.log(1e6) / math.log1p(product))
    return numbers


def at_rest(finished: Finished) -> Metrics:
    """Return where the passes bring the block to rest, and how far that is from its own shortening."""
    block = load_scene(AUGMENTED)
    last = float(finished.needed_history(AUGMENTED, "dda").displacement[-1])
    _, height = statics.size(block)
    shortening = block.load.pressure * height / (2 * block.block.young)
    return {"displacement, mm": 1e3 * last, "penetration left, nm": -1e9 * (last + shortening)}


def explicit_limits(finished: Finished) -> Metrics:
    """Return the largest step of the leapfrog on the locked block [ms]."""
    limits = {}
    for stiffness, word in ((1e9, "1E"), (1e10, "10E"), (1e11, "100E")):
        omega = spectra.contact_frequency(paper_block(stiffness))
        limits[f"p = {word}"] = 1e3 * Stepping.named("leapfrog").critical_omega / omega
    return limits


def opened_errors(runs: Mapping[str, Scene], exact: Mapping[str, Scene], finished: Finished) -> Metrics:
    """Return the relative L2 displacement error over 0.05 s of contact that opens, by scheme and p."""
    errors = {}
    for word, case in runs.items():
        rows = round(0.05 / case.time.step)
        history = finished.needed_history(case.name, "dda").displacement[:rows]
        exact_case = exact[word.rpartition(" ")[2]]
        expected = finished.needed_history(exact_case.name, "block-events").displacement[:rows]
        errors[word] = float(np.linalg.norm(history - expected) / np.linalg.norm(expected))
    return errors


def derived(runs: Mapping[str, Scene], exact: Mapping[str, Scene]) -> DerivedRows:
    """Return the rows: runs of contact that opens by scheme and p, the exact ones by p."""
    computed = {
        "mean rebound": impacts,
        "dashpot": dashpots,
        "passes": passes,
        "largest explicit step, ms": explicit_limits,
    }
    needs = [(case.name, "dda") for case in runs.values()] + [(case.name, "block-events") for case in exact.values()]
    return (
        *(Derived(FACTS, name, (), compute) for name, compute in computed.items()),
        Derived(AUGMENTED, "at rest", ((AUGMENTED, "dda"),), at_rest),
        Derived(FACTS, "error where contact opens", tuple(needs), functools.partial(opened_errors, runs, exact)),
    )
