"""The two-block model as its authors would write it in an afternoon, in plain numpy, and with one slip at a time.

The block of Poisson's ratio 0 is two unknowns, the centroid's displacement v and the strain ey. Nothing of the suite
is imported: this is another person's code.
"""

import time

import numpy as np


def history(scene, *, density=1.0, springs=1.0, delta=None, start=None):
    """Return (displacement, contact pressure) of a scene, with slips as factors or as other values."""
    if scene.block.poisson != 0 or scene.block.vertices is not None or scene.load.eccentricity != 0:
        raise NotImplementedError("an upright rectangle of Poisson's ratio 0 under a centred load only")
    t, block = scene.time, scene.block
    (x0, y0), (x1, y1) = block.outline[0], block.outline[2]
    width, height = x1 - x0, y1 - y0
    p, q, mass = springs * scene.contact.stiffness, scene.load.pressure, density * block.density * width * height
    M = np.array([mass, mass * height**2 / 12])
    K = np.array([[2 * p, -p * height], [-p * height, block.young * width * height + p * height**2 / 2]])
    F = -q * width * np.array([1, height / 2])
    S = np.linalg.inv(np.diag(M) + t.alpha * t.step**2 * K)
    delta = t.delta if delta is None else delta
    D, V = np.zeros(2), np.zeros(2)
    A = F / M if (start or t.start) == "consistent" else np.zeros(2)
    found = np.empty((t.steps, 2))
    for n in range(t.steps):
        ahead = D + t.discount * t.step * V + (0.5 - t.alpha) * t.step**2 * A
        new = S @ (F - K @ ahead)
        D = ahead + t.alpha * t.step**2 * new
        V = t.discount * V + t.step * ((1 - delta) * A + delta * new)
        A = new
        found[n] = D[0], -2 * scene.contact.stiffness * springs * (D[0] - height / 2 * D[1]) / width
    return found[:, 0], found[:, 1]


def sound(scene):
    return history(scene)


def delta_missing(scene):
    """(7) as V = gg V0 + dt A."""
    return history(scene, delta=1.0)


def half_springs(scene):
    return history(scene, springs=0.5)


def zero_start(scene):
    return history(scene, start="zero")


def consistent_start(scene):
    return history(scene, start="consistent")


def late_pressure(scene):
    displacement, pressure = history(scene)
    return displacement, np.concatenate([[0.0], pressure[:-1]])


def double_density(scene):
    return history(scene, density=2.0)


def raises_in_one_scene(scene):
    if scene.name.startswith("figure-8"):
        raise_it()
    return history(scene)


def raise_it():
    raise ZeroDivisionError("no step left")


def raises(scene):
    return np.linalg.solve(np.zeros((2, 2)), np.ones(2))


def millimetres(scene):
    displacement, pressure = history(scene)
    return 1000 * displacement, pressure


def not_a_number(scene):
    displacement, pressure = history(scene)
    displacement[3] = np.nan
    return displacement, pressure


def short(scene):
    displacement, pressure = history(scene)
    return displacement[:-1], pressure[:-1]


def prints(scene):
    print("step\n" * 20_000)
    return history(scene)


def hangs(scene):
    time.sleep(600)
