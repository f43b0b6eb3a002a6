"""The two-block model in high-precision arithmetic: plain Newmark in D, from the doubles of the data.

Independent of the package's matrices: areas, springs, loads and the step are written again here, in
the textbook unknowns and with the textbook order of operations, which many digits make harmless. Matrices are those of
mpmath; the steps are made with `decimal`, whose numbers of as many digits are compiled.
"""

from decimal import Context, Decimal, localcontext

from mpmath import mp, mpf

DIGITS = 80


def integrals(points):
    """Return area, centroid and central second moments (s, x0, y0, s1, s2, s3)."""
    s = sx = sy = sxx = syy = sxy = mpf(0)
    for (x, y), (X, Y) in zip(points, points[1:] + points[:1], strict=True):
        c = x * Y - X * y
        s += c / 2
        sx += c * (x + X) / 6
        sy += c * (y + Y) / 6
        sxx += c * (x * x + x * X + X * X) / 12
        syy += c * (y * y + y * Y + Y * Y) / 12
        sxy += c * (x * Y + 2 * x * y + 2 * X * Y + X * y) / 24
    x0, y0 = sx / s, sy / s
    return s, x0, y0, sxx - x0 * sx, syy - y0 * sy, sxy - x0 * sy


def displacement_rows(x, y):
    """Return the two rows of T at a point relative to the centroid."""
    return [1, 0, -y, x, 0, y / 2], [0, 1, x, 0, y, x / 2]


def matrices(model):
    """Return M, K, F and the row of the contact pressure, as mp matrices and lists."""
    block, material, contact = model.block, model.block.material, model.contact
    points = [(mpf(float(x)), mpf(float(y))) for x, y in block.corners]
    s, x0, y0, s1, s2, s3 = integrals(points)
    rho, E, mu = mpf(material.density), mpf(material.young), mpf(material.poisson)
    M = mp.zeros(6)
    M[0, 0] = M[1, 1] = s
    M[2, 2], M[3, 3], M[4, 4], M[5, 5] = s1 + s2, s1, s2, (s1 + s2) / 4
    for i, j, value in ((2, 3, -s3), (2, 4, s3), (2, 5, (s1 - s2) / 2), (3, 5, s3 / 2), (4, 5, s3 / 2)):
        M[i, j] = M[j, i] = value
    M *= rho
    G = E / (2 * (1 + mu))
    lam = E * mu / (1 - mu**2) if material.hypothesis == "plane stress" else E * mu / ((1 + mu) * (1 - 2 * mu))
    K = mp.zeros(6)
    K[3, 3] = K[4, 4] = s * (lam + 2 * G)
    K[3, 4] = K[4, 3] = s * lam
    K[5, 5] = s * G
    centred = [(x - x0, y - y0) for x, y in points]
    ends = [centred[(model.base + i) % len(points)] for i in (0, 1)]
    tx, ty = ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]
    a = mp.sqrt(tx**2 + ty**2)
    tx, ty = tx / a, ty / a
    pn, ps = mpf(contact.normal), mpf(contact.shear)
    pressure = [mpf(0)] * 6
    for x, y in ends:
        u, v = displacement_rows(x, y)
        normal = [tx * b - ty * c for b, c in zip(v, u, strict=True)]
        shear = [tx * b + ty * c for b, c in zip(u, v, strict=True)]
        for i in range(6):
            pressure[i] -= pn * normal[i] / a
            for j in range(6):
                K[i, j] += pn * normal[i] * normal[j] + ps * shear[i] * shear[j]
    (x1, y1), (x2, y2) = (centred[(model.top + i) % len(points)] for i in (0, 1))
    length = mp.sqrt((x2 - x1) ** 2 + (y2 - y1) ** 2)
    row = displacement_rows((x1 + x2) / 2, (y1 + y2) / 2)[1]
    F = mp.matrix([-mpf(model.pressure) * length * t for t in row])
    return M, K, F, pressure


def decimal(x):
    """Return a number of mpmath as a decimal one, with more digits than it has."""
    return Decimal(mp.nstr(x, DIGITS + 5))


def _apply(rows, x):
    """Return a matrix, kept as lists of (column, entry), times a list."""
    return [sum(value * x[j] for j, value in row) for row in rows]


def _rows(matrix):
    """Return a matrix as lists of its non-zero (column, entry)."""
    return [[(j, decimal(matrix[i, j])) for j in range(6) if matrix[i, j]] for i in range(6)]


def history(model, scheme, steps):
    """Return v of the centroid and the contact pressure of every step, as lists of mpf."""
    with mp.workdps(DIGITS), localcontext(Context(prec=DIGITS)):
        M, K, F, pressure = matrices(model)
        h = mpf(scheme.alpha) * mpf(scheme.step) ** 2
        S_inverse, M_inverse = (M + h * K) ** -1, M**-1
        SM, SK, MK = _rows(S_inverse * M), _rows(h * S_inverse * K), _rows(M_inverse * K)
        SF, MF, pressure = (list(map(decimal, given)) for given in (h * S_inverse * F, M_inverse * F, pressure))
        alpha, delta, gg, dt = (Decimal(float(x)) for x in (scheme.alpha, scheme.delta, scheme.gg, scheme.step))
        D, V = [Decimal(0)] * 6, [Decimal(0)] * 6
        A = list(MF) if scheme.start == "consistent" else [Decimal(0)] * 6
        displacement, contact = [], []
        for _ in range(steps):
            ahead = [gg * dt * v + dt**2 * (Decimal("0.5") - alpha) * a for v, a in zip(V, A, strict=True)]
            moved, held = _apply(SM, ahead), _apply(SK, D)
            D = [d + m - k + f for d, m, k, f in zip(D, moved, held, SF, strict=True)]
            A1 = [f - x for f, x in zip(MF, _apply(MK, D), strict=True)]
            V = [gg * v + dt * ((1 - delta) * a + delta * b) for v, a, b in zip(V, A, A1, strict=True)]
            A = A1
            displacement.append(D[1])
            contact.append(sum(p * d for p, d in zip(pressure, D, strict=True)))
        return [mpf(str(v)) for v in displacement], [mpf(str(p)) for p in contact]


def lost(values, exact):
    """Return the maximum error over the maximum value."""
    with mp.workdps(DIGITS):
        peak = max(abs(x) for x in exact)
        if peak == 0:
            return 0.0 if all(v == 0 for v in values) else float("inf")
        return float(max(abs(mpf(float(v)) - x) for v, x in zip(values, exact, strict=True)) / peak)
