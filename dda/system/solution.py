r"""Histories, statics and modes of a system of blocks.

One step solves for the increments of the displacements D and of the joint forces, with
mu = dt^2 lambda, k = dt^2 Ke, C' = C / dt^2 and S = M + alpha k, which is a matrix of 6 x 6 blocks:

    S dD + alpha B' dmu = gg P + (1/2 - alpha) f + alpha (F - k D - B' mu) = r
    B dD - C' dmu = G dy

by (C' + alpha B S^-1 B') dmu = B S^-1 r - G dy, whose matrix is sparse, positive definite and
factorised once. Then f1 = F - k D1 - B' mu1 and P1 = gg P + (1 - delta) f + delta f1, as for one block.
The force of a joint is never its stiffness times a difference of displacements. Other schemes take one stage or two
of this form (`dda.scheme.stage`), with alpha (1 - af)/(1 - am) for alpha in the matrices.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from dda.model.arrays import Array
from dda.one_block.modes import Mode, modes_of
from dda.one_block.solution import Result, check_damping, check_request, linear_result
from dda.scheme import harmonic
from dda.scheme.harmonic import largest_frequency
from dda.scheme.newmark import Scheme, late_momentum
from dda.scheme.stage import Stage, effective_matrix, implicit_weight, inertia_force, predictor, velocity_corrector
from dda.system.system import BlockSystem, Equations, Factor, factor, inverses

if TYPE_CHECKING:
    from scipy.sparse import csr_array

_STIFF = (1e4, 1e7)  # stiffness over inertia of a block in S from which each correction is due


def joint_flexibility(stage: Stage, C: csr_array, B: csr_array, inverse: csr_array) -> csr_array:
    """Return C' + alpha B S^-1 B', the matrix of the joint forces' increments."""
    return C + implicit_weight(stage) * (B @ inverse @ B.T)


class StageSolver:
    """The equations of a stage; everything is multiplied by dt^2 where the module says so."""

    def __init__(self, equations: Equations, stage: Stage) -> None:
        """Form the matrices and factorise the one of the joint forces."""
        self.stage = stage
        self.weight = implicit_weight(stage)
        k = stage.step**2 * equations.elastic
        B = equations.B
        S = effective_matrix(stage, equations.mass, k)
        self.k = equations.blockwise(k)
        self.B = B
        self.Bt = B.T.tocsr()
        self.inverse = equations.blockwise(inverses(S))
        self.BS = (B @ self.inverse).tocsr()
        self.BSt = self.BS.T.tocsr()
        self.S = equations.blockwise(S)
        self.C = equations.C / stage.step**2
        flexibility = joint_flexibility(stage, self.C, B, self.inverse)
        self.factor = factor(flexibility) if B.shape[0] else Factor(np.copy, 0)
        stiff = self.weight * float(np.max(np.einsum("nii->ni", k) / np.einsum("nii->ni", equations.mass)))
        self.corrections = sum(stiff > limit for limit in _STIFF)

    def increments(self, r: Array, push: Array) -> tuple[Array, Array]:
        """Return dD and dmu of S dD + alpha B' dmu = r, B dD - C' dmu = G dy.

        Where a block's stiffness outweighs its inertia in S, its rigid motion is a small difference
        of joint forces: each correction takes the digits back that this costs.
        """
        dD, dmu = self._solve(r, push)
        for _ in range(self.corrections):
            residual = r - self.S @ dD - self.weight * (self.Bt @ dmu)
            correction = self._solve(residual, push - self.B @ dD + self.C @ dmu)
            dD = dD + correction[0]
            dmu = dmu + correction[1]
        return dD, dmu

    def _solve(self, r: Array, push: Array) -> tuple[Array, Array]:
        dmu = self.factor.solve(self.BS @ r - push)
        return self.inverse @ r - self.weight * (self.BSt @ dmu), dmu


class Stepper:
    """The scheme on a system, stage by stage."""

    def __init__(self, equations: Equations, scheme: Scheme) -> None:
        """Form and factorise the matrices of all stages."""
        self.equations = equations
        self.scheme = scheme
        self.stages = [StageSolver(equations, stage) for stage in scheme.stages]

    def run(self, steps: int, rows: tuple[Array, Array], moved: Array) -> Array:
        """Return the observed rows of D and lambda at every step, (rows, steps).

        Parameters
        ----------
        moved : (1 + stages * steps, 2) array
            Displacement of what is fixed at t = 0 and at the end of each stage, over the size of the loads.
        """
        e = self.equations
        s = self.scheme
        F = s.step**2 * e.F
        pushes = iter(np.diff(moved, axis=0) @ e.G.T)
        by_D = rows[0]
        by_mu = rows[1] / s.step**2
        D = np.zeros_like(F)
        mu = -(s.step**2 * (e.kappa @ (e.G @ moved[0])))
        force = F - self.stages[0].Bt @ mu
        f = force if s.start == "consistent" else 0 * F
        P = late_momentum(s, np.zeros_like(F), f)
        observed = np.empty((len(by_D), steps))
        for n in range(steps):
            P_0 = P
            f_0 = f
            force_0 = force
            for solver in self.stages:
                stage = solver.stage
                f_g = f
                balance = predictor(stage, P_0, f_0, P, f_g)
                balance = balance + stage.alpha * inertia_force(stage, force, force_0, f_0)
                dD, dmu = solver.increments(balance, next(pushes))
                D = D + dD
                mu = mu + dmu
                force = F - (solver.k @ D + solver.Bt @ mu)
                f = inertia_force(stage, force, force_0, f_0)
                P = velocity_corrector(stage, P_0, f_0, f_g, f)
            observed[:, n] = by_D @ D + by_mu @ mu
        return observed


class _ViscousStepper(Stepper):
    """The scheme with C = a0 M + a1 K, in the displacement G = D + a1 V that the damped springs resist.

    With v = dt V, q = dt^2 A, m = 1 + delta a0 dt and beta = alpha + delta a1 / dt the end of a step obeys

        m M q1 + a0 dt M v* + k G1 + B' mu1 = F,      G1 = G* + beta q1,

    a step of the undamped equations with beta / m for alpha; mu are the forces of springs and dashpots together.
    """

    def __init__(self, equations: Equations, scheme: Scheme) -> None:
        """Form the matrices of the undamped step that stands for the damped one."""
        self.damped_scheme = scheme
        self.lag = scheme.stiffness_damping / scheme.step
        self.drag = scheme.mass_damping * scheme.step
        self.mass_factor = 1 + scheme.delta * self.drag
        self.beta = scheme.alpha + scheme.delta * self.lag
        alpha = self.beta / self.mass_factor
        super().__init__(equations, replace(scheme, alpha=alpha, mass_damping=0.0, stiffness_damping=0.0))
        self.M = equations.blockwise(equations.mass)
        self.inverse_mass = equations.blockwise(inverses(equations.mass))

    def run(self, steps: int, rows: tuple[Array, Array], moved: Array) -> Array:
        """Return the observed rows of D and of the springs' own forces at every step, (rows, steps)."""
        e = self.equations
        s = self.damped_scheme
        (stage,) = s.stages
        F = self.scheme.step**2 * e.F
        solver = self.stages[0]
        still = np.zeros(len(e.pressure))
        observed_by = rows[0] + (e.B.T @ (e.kappa @ rows[1].T)).T
        D, v, G = np.zeros((3, len(F)))
        q = self.inverse_mass @ F if s.start == "consistent" else 0 * F
        mu = still
        observed = np.empty((len(observed_by), steps))
        for n in range(steps):
            D = D + predictor(stage, v, q, v, q)
            v = velocity_corrector(stage, v, q, q, 0 * q)
            ahead = D + self.lag * v
            drag = self.drag * (self.M @ v)
            internal = solver.k @ G + solver.Bt @ mu
            r = self.M @ (ahead - G) + self.scheme.alpha * (F - drag - internal)
            dG, dmu = solver.increments(r, still)
            G = G + dG
            mu = mu + dmu
            q = self.inverse_mass @ (F - drag - solver.k @ G - solver.Bt @ mu) / self.mass_factor
            if self.beta:  # alpha q as a difference of what the springs feel: stiff ones keep their digits
                D = D + s.alpha / self.beta * (G - ahead)
            v = v + s.delta * q
            observed[:, n] = observed_by @ D
        return observed


def solve_system(
    system: BlockSystem,
    scheme: Scheme,
    steps: int,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    full: bool = False,
) -> Result:
    """Step a system of blocks from rest and return the asked columns.

    Parameters
    ----------
    steps : int
        Number of steps.
    columns : sequence of str
        Any of `dda.COLUMNS`, at the system's observed point.
    full : bool
        Keep all unknowns, also those that no load can reach.

    Raises
    ------
    ValueError
        If the number of steps is not positive or a column is unknown.
    """
    import scipy.sparse.linalg  # noqa: F401  (before the clock starts)

    check_request(steps, columns)
    check_damping(scheme, system.motion is not None)
    began = perf_counter()
    equations = system.equations if full else system.reached
    return stepped(system, equations, scheme, steps, columns, equations.rows(columns), began)


def stepped(
    system: BlockSystem,
    equations: Equations,
    scheme: Scheme,
    steps: int,
    names: Sequence[str],
    rows: tuple[Array, Array],
    began: float,
) -> Result:
    """Step a system from rest and return what some rows, of D and of the joint forces, observe of it.

    Parameters
    ----------
    equations
        In the unknowns that are kept.
    began
        When the set-up began [s].
    """
    stepper = _ViscousStepper(equations, scheme) if scheme.damped else Stepper(equations, scheme)
    ready = perf_counter()
    with np.errstate(all="ignore"):
        observed = stepper.run(steps, rows, _moved(system, scheme.instants(steps))) * system.load_size
    return linear_result(
        scheme,
        (began, ready),
        names,
        observed,
        system.load_size,
        unknowns=len(equations.F),
        nonzeros=stepper.stages[-1].factor.nonzeros,
        factorisations=len(stepper.stages),
        solves=steps * sum(1 + solver.corrections for solver in stepper.stages),
        notes=_savings(system, equations),
    )


def _moved(system: BlockSystem, instants: Array) -> Array:
    """Return the displacement of what is fixed over the size of the loads, (instants, 2)."""
    if system.motion is None:
        return np.zeros((len(instants), 2))
    return system.motion.at(instants) / system.load_size


def _savings(system: BlockSystem, equations: Equations) -> tuple[str, ...]:
    """Say how many unknowns were kept if not all of them."""
    total = len(system.equations.F)
    unknowns = len(equations.F)
    return () if unknowns == total else (f"{unknowns} of {total} unknowns kept",)


def static_system(system: BlockSystem) -> dict[str, float]:
    """Return the value of every column at rest under the constant loads, on the base's last position."""
    equations = system.reached
    names = (*equations.observers, "contact_pressure")
    by_D, by_force = equations.rows(names)
    last = _moved(system, np.array([math.inf]))[0]
    D, force = equations.at_rest(equations.F, equations.G @ last)
    values = (by_D @ D + by_force @ force) * system.load_size + 0.0
    return dict(zip(names, values.tolist(), strict=True))


def system_modes(system: BlockSystem, scheme: Scheme, count: int = 12, full: bool = False) -> tuple[Mode, ...]:
    """Return modes of a system, the largest static share first.

    Parameters
    ----------
    count : int
        Number of lowest modes; doubled until the mode of the largest share is among them.
    full : bool
        Count the modes that no load can reach as well.
    """
    equations = system.equations if full else system.reached
    solve = equations.at_rest
    F = _pushed(system, equations)
    D, _ = solve(F, np.zeros(len(equations.pressure)))
    while True:
        squares, shapes, forces = lowest_modes(equations, solve, count)
        shares = (shapes.T @ F) ** 2 / (squares * (F @ D))
        if len(squares) < count or np.max(shares) > 1 - np.sum(shares):
            break
        count *= 2
    carried = (equations.pressure @ forces) * (shapes.T @ F) / squares
    return modes_of(scheme, np.sqrt(squares), shares, carried, np.argsort(-shares, kind="stable"))


def _pushed(system: BlockSystem, equations: Equations) -> Array:
    """Return the load that shares refer to: the constant one, else M R of the moving base, else a weight."""
    if np.any(equations.F):
        return equations.F
    axes = np.zeros(6)
    if system.motion is not None:
        axes[:2] = np.any(np.asarray(system.motion.displacement) != 0, axis=0)
    if not np.any(axes):
        axes[1] = 1.0
    return np.asarray(equations.blockwise(equations.mass) @ axes[equations.kept % 6])


def lowest_modes(
    equations: Equations, solve: Callable[[Array, Array], tuple[Array, Array]], count: int
) -> tuple[Array, Array, Array]:
    """Return the lowest w^2, their mass-normalised shapes and the joint forces of the shapes.

    K^-1 is applied by the saddle-point solver, so that stiff joints cost no digits.
    """
    from scipy.linalg import eigh
    from scipy.sparse.linalg import LinearOperator, eigsh

    M = equations.blockwise(equations.mass)
    n = len(equations.F)
    still = np.zeros(len(equations.pressure))

    def flexibility(right: Array) -> Array:
        return solve(np.ravel(right), still)[0]

    if n <= harmonic.DENSE or count >= n - 1:
        root = np.linalg.cholesky(M.toarray())
        values, vectors = eigh(root.T @ np.array([flexibility(column) for column in root.T]).T)
        order = np.argsort(-values)[:count]
        squares = 1 / values[order]
        shapes = np.linalg.solve(root.T, vectors[:, order])
    else:
        inverse = LinearOperator((n, n), matvec=flexibility, dtype=float)
        start = np.random.default_rng(0).standard_normal(n)
        squares, shapes = eigsh(M, count, M, sigma=0.0, OPinv=inverse, v0=start)
    forces = [solve(w2 * (M @ phi), still)[1] for w2, phi in zip(squares, shapes.T, strict=True)]
    return squares, shapes, np.array(forces).T


def highest_frequency(system: BlockSystem) -> float:
    """Return the largest natural frequency [rad/s], which limits a conditionally stable scheme."""
    e = system.reached
    K = e.blockwise(e.elastic) + e.B.T @ e.kappa @ e.B
    return largest_frequency(K.tocsr(), e.blockwise(e.mass))
