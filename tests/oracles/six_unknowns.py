"""`sliding_block` as somebody's solver of a rectangle on springs that pull, right and with a slip of each kind."""

import time
from dataclasses import replace

import numpy as np
from sliding_block import Plain, run


def program(scene):
    """Return a scene as the program takes it."""
    if scene.block.vertices is not None or scene.contact.law != "locked" or scene.load.gravity:
        raise NotImplementedError("a rectangle on springs that pull, under a pressure")
    t, block, contact, load = scene.time, scene.block, scene.contact, scene.load
    (x0, y0), (x1, y1) = block.outline[0], block.outline[2]
    return Plain(
        *(t.step, t.steps, x1 - x0, y1 - y0),
        *(block.density, block.young, block.poisson, block.hypothesis == "plane strain"),
        *(contact.stiffness, contact.shear, load.pressure, load.eccentricity),
        alpha=t.alpha,
        delta=t.delta,
        gg=t.discount,
        consistent=t.start == "consistent",
    )


def author(slip):
    """Return a solver of somebody who has changed what `slip` says."""

    def solve(scene):
        P = program(scene)
        return run(replace(P, **(slip(P) if callable(slip) else slip)))

    return solve


SLIPS = {  # what is changed, or what it is made of the program
    "plane_stress": {"strain": False},
    "plane_strain": {"strain": True},
    "interchanged": lambda P: {"side": P.height, "height": P.side},
    "squared": lambda P: {"height": P.side},
    "without_poisson": {"mu": 0.0},
    "one_stiffness": lambda P: {"ps": P.p},
    "without_shear": {"ps": 0.0},
    "central": {"eccentricity": 0.0},
    "delta_missing": {"delta": 1.0},  # (7) as V = gg V0 + dt A
    "zero_start": {"consistent": False},
    "consistent_start": {"consistent": True},
    "late_pressure": {"late": 1},
    "gg_twice": lambda P: {"gg": P.gg**2},
    "undamped": {"alpha": 0.25, "delta": 0.5, "gg": 1.0},
    # plane strain by a modulus alone, which no one known misreading is
    "turned_plane": lambda P: {"strain": False, "mu": 1.4 * P.mu} if P.strain else {},
    "without_poisson_and_central": {"mu": 0.0, "eccentricity": 0.0},
    "half_springs": lambda P: {"p": P.p / 2, "ps": P.ps / 2},
    "double_density": lambda P: {"rho": 2 * P.rho},
    "millimetres": {"displacement_times": 1e3},
}
for name, slip in SLIPS.items():
    globals()[name] = author(slip)
sound = author({})


def raises_in_one_scene(scene):
    if scene.name.startswith("figure-8"):
        raise_it()
    return sound(scene)


def raise_it():
    raise ZeroDivisionError("no step left")


def raises(scene):
    return np.linalg.solve(np.zeros((2, 2)), np.ones(2))


def not_a_number(scene):
    displacement, pressure = sound(scene)
    displacement[3] = np.nan
    return displacement, pressure


def short(scene):
    displacement, pressure = sound(scene)
    return displacement[:-1], pressure[:-1]


def prints(scene):
    print("step\n" * 20_000)
    return sound(scene)


def hangs(scene):
    time.sleep(600)
