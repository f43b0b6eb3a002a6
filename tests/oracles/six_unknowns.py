"""A block with all six unknowns and corner springs in plain numpy, as another person writes it, with slips as options.

The unknowns are those of a constant-strain block, (u, v, r, ex, ey, gxy) about the centroid. Nothing of the suite is
imported, but for the scene that is handed in.
"""

import time

import numpy as np


def place(x, y):
    """Displacement at (x, y) from the centroid: u and v of the six unknowns, shape (2, 6)."""
    return np.array([[1, 0, -y, x, 0, y / 2], [0, 1, x, 0, y, x / 2]])


def history(
    scene,
    *,
    sides=lambda w, h: (w, h),
    poisson=None,
    hypothesis=None,
    shear=None,
    eccentricity=None,
    density=1.0,
    springs=1.0,
    delta=None,
    start=None,
    discounts=1,
    alpha=None,
):
    """Return (displacement, contact pressure) of a scene; a keyword is what a slip has in its place."""
    if scene.block.vertices is not None or scene.contact.law != "locked" or scene.load.gravity:
        raise NotImplementedError("a rectangle on springs that pull, under a pressure")
    t, block, contact = scene.time, scene.block, scene.contact
    (x0, y0), (x1, y1) = block.outline[0], block.outline[2]
    width, height = sides(x1 - x0, y1 - y0)
    area = width * height
    mu = block.poisson if poisson is None else poisson
    young = block.young
    if (hypothesis or block.hypothesis) == "plane strain":
        young, mu = young / (1 - mu**2), mu / (1 - mu)
    plate = young / (1 - mu**2)
    normal = springs * contact.stiffness
    tangential = springs * contact.shear if shear is None else shear * normal
    alpha = t.alpha if alpha is None else alpha
    delta = t.delta if delta is None else delta
    gg = t.discount**discounts

    mass = density * block.density * area
    ix, iy = (mass * side**2 / 12 for side in (width, height))
    M = np.diag([mass, mass, ix + iy, ix, iy, (ix + iy) / 4])
    M[2, 5] = M[5, 2] = (ix - iy) / 2
    K = np.zeros((6, 6))
    K[3:, 3:] = area * plate * np.array([[1, mu, 0], [mu, 1, 0], [0, 0, (1 - mu) / 2]])
    corners = [place(x, -height / 2) for x in (-width / 2, width / 2)]
    for T in corners:
        K += tangential * np.outer(T[0], T[0]) + normal * np.outer(T[1], T[1])
    e = scene.load.eccentricity if eccentricity is None else eccentricity
    F = -scene.load.pressure * (width - 2 * abs(e)) * place(e, height / 2)[1]

    S = np.linalg.inv(M + alpha * t.step**2 * K)
    D, V, A = np.zeros(6), np.zeros(6), np.zeros(6)
    if (start or t.start) == "consistent":
        A = np.linalg.solve(M, F)
    rows = np.empty((t.steps, 2))
    for n in range(t.steps):
        ahead = D + gg * t.step * V + (0.5 - alpha) * t.step**2 * A
        new = S @ (F - K @ ahead)
        D = ahead + alpha * t.step**2 * new
        V = gg * V + t.step * ((1 - delta) * A + delta * new)
        A = new
        rows[n] = D[1], -normal * sum(T[1] @ D for T in corners) / width
    return rows[:, 0], rows[:, 1]


def sound(scene):
    return history(scene)


def plane_stress(scene):
    return history(scene, hypothesis="plane stress")


def plane_strain(scene):
    return history(scene, hypothesis="plane strain")


def interchanged(scene):
    return history(scene, sides=lambda w, h: (h, w))


def squared(scene):
    return history(scene, sides=lambda w, h: (w, w))


def without_poisson(scene):
    return history(scene, poisson=0.0)


def one_stiffness(scene):
    return history(scene, shear=1.0)


def without_shear(scene):
    return history(scene, shear=0.0)


def central(scene):
    return history(scene, eccentricity=0.0)


def delta_missing(scene):
    """(7) as V = gg V0 + dt A."""
    return history(scene, delta=1.0)


def zero_start(scene):
    return history(scene, start="zero")


def consistent_start(scene):
    return history(scene, start="consistent")


def late_pressure(scene):
    displacement, pressure = history(scene)
    return displacement, np.concatenate([[0.0], pressure[:-1]])


def gg_twice(scene):
    return history(scene, discounts=2)


def undamped(scene):
    return history(scene, alpha=0.25, delta=0.5, discounts=0)


def turned_plane(scene):
    """Plane strain by a modulus alone, which no one known misreading is."""
    if scene.block.hypothesis == "plane strain":
        return history(scene, hypothesis="plane stress", poisson=1.4 * scene.block.poisson)
    return history(scene)


def without_poisson_and_central(scene):
    return history(scene, poisson=0.0, eccentricity=0.0)


def half_springs(scene):
    return history(scene, springs=0.5)


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
