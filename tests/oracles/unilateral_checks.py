"""Random blocks on corners that open, and the invariants that their histories obey to rounding."""

import numpy as np

from dda import Block, Material, Scheme, Unilateral, UnilateralModel, UnilateralOptions, solve_unilateral

DT = 3e-4
ENERGIES = UnilateralOptions(energies=True)


def random_model(seed, glued=None):
    """Return a block at random data: outline, material, loads, gap and speed; some are symmetric."""
    rng = np.random.default_rng(seed)
    a, h = rng.uniform(0.8, 2.5, 2)
    lean = rng.uniform(-0.3, 0.3) if seed % 3 == 0 else 0.0
    corners = [[0, 0], [a, 0], [a + lean, h], [lean, h * (1 + 0.2 * (seed % 3 == 0))]]
    young = 10 ** rng.uniform(8.5, 9.5)
    p = young * 10 ** rng.uniform(-0.5, 2)
    symmetric = seed % 3 == 1
    shear = (rng.uniform(0.2, 1.0) if (glued if glued is not None else seed % 2) else 0.0) * p
    return UnilateralModel(
        Block(corners, Material(rng.uniform(1500, 3000), young, rng.uniform(-0.2, 0.4))),
        Unilateral(p, shear, rng.uniform(0, 1e-3) * (seed % 4 == 0)),
        pressure=young * rng.uniform(1e-3, 5e-3),
        eccentricity=0.0 if symmetric else rng.uniform(-0.2, 0.2) * a,
        traction=0.0 if symmetric else young * rng.uniform(-1e-4, 1e-4),
        gravity=rng.uniform(0, 15),
        velocity=rng.uniform(-1.5, 1.0),
    )


def sums(result):
    """Return total energy and total losses [J]."""
    e = result.energies
    return (
        e["kinetic"] + e["strain"] + e["springs"] + e["load"],
        e["algorithmic"] + e["kinetic damping"] + e["switching"] + e["friction"],
    )


def apart(values, others):
    """Return the greatest difference over the greatest of the other values."""
    return np.max(np.abs(values - others)) / max(np.max(np.abs(others)), 1e-300)


def size(result):
    """Return the greatest energy of a history [J]."""
    return max(np.max(np.abs(values)) for values in result.energies.values())


def complementarity(model, result):
    """N >= 0, an open point without force, a closed one at w = -N/p, of its share of p of two corners."""
    p = 2 * model.contact.stiffness / len(result.normal)
    N, T, w, shut = result.normal, result.shear, result.gap, result.closed
    assert np.all(N >= 0)
    assert np.all(N[~shut] == 0) and np.all(T[~shut] == 0) and np.all(w[~shut] >= 0)
    assert np.allclose(w[shut], -N[shut] / p, rtol=1e-14, atol=0)


def momentum(model, scheme, result, digits=1e-14):
    """M dV = dt [(1 - delta) R_n + delta R_{n+1}] + (gg - 1) m V, both directions."""
    mass = model.block.material.density * model.block.section.area
    x, y = model.block.corners[[model.top, (model.top + 1) % 4]].T
    part = 1 - 2 * abs(model.eccentricity) / np.hypot(x[1] - x[0], y[1] - y[0])
    length = np.hypot(x[1] - x[0], y[1] - y[0])
    right, up = model.load.falling
    weight = mass * model.gravity
    loads = (model.traction * length + weight * right, -model.pressure * part * length + weight * up)
    contact = (result.shear.sum(axis=0), result.normal.sum(axis=0))
    starts = (0.0, model.velocity)
    for V, N, load, start in zip((result.horizontal_velocity, result.velocity), contact, loads, starts, strict=True):
        R = load + np.concatenate([[0.0], N])
        R0 = R.copy()
        R0[0] = load if scheme.start == "consistent" else 0.0
        V = np.concatenate([[start], V])
        impulse = scheme.step * ((1 - scheme.delta) * R0[:-1] + scheme.delta * R[1:])
        residual = mass * (V[1:] - scheme.gg * V[:-1]) - impulse
        size = mass * np.max(np.abs(V)) + scheme.step * np.max(np.abs(R)) + scheme.step * abs(loads[1])
        assert np.max(np.abs(residual)) < digits * size * np.sqrt(len(residual))


def energy(model, result, digits=1e-12):
    """Energy and the losses, each computed from its own formula, sum up to what there was at the start."""
    total, lost = sums(result)
    first = model.block.material.density * model.block.section.area * model.velocity**2 / 2
    assert np.max(np.abs(total + lost - first)) < digits * size(result)


def run(model, alpha=0.5, delta=1.0, gg=1.0, dt=DT, start="zero", steps=400, **options):
    """Run with the scheme's numbers."""
    return solve_unilateral(model, Scheme(alpha, delta, gg, dt, start), steps, options=UnilateralOptions(**options))
