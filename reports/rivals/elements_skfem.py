"""Rivals of `fem`: the loop that a competent user writes with scikit-fem and SuperLU, and the lowest modes by `eigsh`.

Bilinear elements on the whole square, a distributed foundation, the step's matrix factored once with the ordering
and the symmetric mode that suit a positive definite matrix (three times faster than SuperLU's default).
"""

import numpy as np
from rivals.block_modes import swings
from scipy.sparse import csr_array, dia_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from skfem import Basis, BilinearForm, ElementQuad1, ElementVector, FacetBasis, LinearForm, MeshQuad
from skfem.helpers import ddot, div, dot, sym_grad


@BilinearForm
def _mass(u, v, w):
    return dot(u, v)


@BilinearForm
def _elastic(u, v, w):
    return w.lam * div(u) * div(v) + 2 * w.mu * ddot(sym_grad(u), sym_grad(v))


@LinearForm
def _down(v, w):
    return -v[1]


def assembled(
    n: int = 64,
    poisson: float = 0.25,
    side: float = 2.0,
    rho: float = 2700.0,
    young: float = 1e9,
    p: float = 1e9,
    q: float = 5e6,
) -> tuple[csr_array, csr_array, np.ndarray, int, np.ndarray]:
    """Return M, K, F, the place of the observed displacement in the vectors, and the row of the contact pressure."""
    grid = np.linspace(0, side, n + 1)
    mesh = MeshQuad.init_tensor(grid, grid)
    basis = Basis(mesh, ElementVector(ElementQuad1()))
    base = FacetBasis(mesh, basis.elem, facets=mesh.facets_satisfying(lambda x: x[1] == 0, boundaries_only=True))
    top = FacetBasis(mesh, basis.elem, facets=mesh.facets_satisfying(lambda x: x[1] == side, boundaries_only=True))
    lam, mu = young * poisson / (1 - poisson**2), young / (2 * (1 + poisson))
    k = 2 * p / side
    M = rho * _mass.assemble(basis)
    K = _elastic.assemble(basis, lam=lam, mu=mu) + k * _mass.assemble(base)
    middle = basis.nodal_dofs[1, np.argmin(np.hypot(*(mesh.p - side / 2)))]
    return M, K, q * _down.assemble(top), middle, k / side * _down.assemble(base)


def history(
    steps: int, dt: float = 1e-3, alpha: float = 0.5, delta: float = 1.0, **square: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement [m] and contact pressure [Pa] of every step of the `assembled` square, plane stress."""
    M, K, F, middle, press = assembled(**square)
    lu = splu(
        (M + alpha * dt**2 * K).tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    D, V, A = np.zeros_like(F), np.zeros_like(F), np.zeros_like(F)
    displacement, contact = np.empty(steps), np.empty(steps)
    for step in range(steps):
        ahead = dt * V + dt**2 * (0.5 - alpha) * A
        dD = lu.solve(M @ ahead + alpha * dt**2 * (F - K @ D))
        A1 = (dD - ahead) / (alpha * dt**2)
        V = V + dt * ((1 - delta) * A + delta * A1)
        D, A = D + dD, A1
        displacement[step] = D[middle]
        contact[step] = press @ D
    return displacement, contact


def modal(
    steps: int, modes: int = 40, dt: float = 1e-3, alpha: float = 0.5, delta: float = 1.0, **square: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the same by the lowest modes alone, each a recursion (`block_modes`), about the whole static answer."""
    M, K, F, middle, press = assembled(**square)
    lu = splu(K.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    rest = lu.solve(F)
    solver = LinearOperator(K.shape, matvec=lu.solve)
    squares, shapes = eigsh(K, modes, M, sigma=0, OPinv=solver)
    distances = swings(squares, -shapes.T @ (M @ rest), steps, dt, alpha, delta)
    rows = np.array([shapes[middle], press @ shapes])
    columns = np.array([[rest[middle]], [press @ rest]]) + rows @ distances
    return columns[0], columns[1]


def opening(
    steps: int,
    n: int = 32,
    poisson: float = 0.25,
    side: float = 2.0,
    rho: float = 2700.0,
    young: float = 1e9,
    p: float = 1e9,
    q: float = 5e6,
    eccentricity: float = 0.25,
    dt: float = 1e-4,
    alpha: float = 0.5,
    delta: float = 1.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the same on springs without friction and tension at the base's nodes, one factor for each closed set."""
    grid = np.linspace(0, side, n + 1)
    mesh = MeshQuad.init_tensor(grid, grid)
    basis = Basis(mesh, ElementVector(ElementQuad1()))
    pressed = mesh.facets_satisfying(lambda x: (x[1] == side) & (x[0] > 2 * eccentricity), boundaries_only=True)
    lam, mu = young * poisson / (1 - poisson**2), young / (2 * (1 + poisson))
    M, K = rho * _mass.assemble(basis), _elastic.assemble(basis, lam=lam, mu=mu)
    F = q * _down.assemble(FacetBasis(mesh, basis.elem, facets=pressed))
    nodes = np.flatnonzero(mesh.p[1] == 0)
    base, springs = basis.nodal_dofs[1, nodes], np.full(len(nodes), 2 * p / n)
    springs[(mesh.p[0, nodes] == 0) | (mesh.p[0, nodes] == side)] /= 2
    sets = {}
    middle = basis.nodal_dofs[1, np.argmin(np.hypot(*(mesh.p - side / 2)))]
    D, V, A, closed = np.zeros_like(F), np.zeros_like(F), np.zeros_like(F), np.ones(len(nodes), bool)
    displacement, contact = np.empty(steps), np.empty(steps)
    for step in range(steps):
        ahead = dt * V + dt**2 * (0.5 - alpha) * A
        for _ in range(20):
            key = closed.tobytes()
            if key not in sets:
                diagonal = np.zeros_like(F)
                diagonal[base] = springs * closed
                Kc = K + dia_array((diagonal[None, :], [0]), shape=K.shape).tocsr()
                options = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
                sets[key] = Kc, splu((M + alpha * dt**2 * Kc).tocsc(), **options)
            Kc, lu = sets[key]
            dD = lu.solve(M @ ahead + alpha * dt**2 * (F - Kc @ D))
            tried, closed = closed, (D + dD)[base] < 0
            if np.array_equal(tried, closed):
                break
        A1 = (dD - ahead) / (alpha * dt**2)
        V = V + dt * ((1 - delta) * A + delta * A1)
        D, A = D + dD, A1
        displacement[step] = D[middle]
        contact[step] = -(springs * closed) @ D[base] / side
    return displacement, contact
