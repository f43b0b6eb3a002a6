"""The claims C1 to C13 of the register: the statements of the paper's sections 2, 4 and 5."""

from __future__ import annotations

import numpy as np

from validation.suite.claims import Evidence, Tests, named, whole

A34, A56, A7, A8, A9 = (
    list(named(name)) for name in ("figures-3-4", "figures-5-6", "figure-7", "figure-8", "figure-9")
)
COARSE, MIDDLE, _ = A34  # dt = 0.01, 0.002, 0.001 at p = 1E
SOFT, STIFF, STIFFEST = A56  # p = 1E, 10E, 100E at dt = 0.002
MAP = named("damping-map")
DISCOUNTS = named("discount-map")
TOLERANCES = np.geomspace(0.002, 0.08, 60)
PEAK = 1000  # steps of figure 7 in which the first and the last peak lie


def cell(p: float, step: float) -> str:
    """Name of the case of the damping map at p/E and dt [s]."""
    return next(
        name for name, s in MAP.items() if s.contact.stiffness == p * s.block.young and np.isclose(s.time.step, step)
    )


def steps_of(evidence: Evidence, case: str) -> dict[str, float]:
    """Return the settling steps at 1 %."""
    return {
        "displacement, steps": evidence.settles(case, "displacement"),
        "contact force, steps": evidence.settles(case, "pressure"),
    }


def equilibrium(e: Evidence) -> dict[str, float]:
    """Return the largest distance of the last pressure from q, over q, and the least remaining."""
    distances = [abs(e.scaled(case, "pressure")[-1] - 1) for case in (*A34, *A56)]
    return {"final distance from q, largest of six runs": max(distances)}


def force_first(e: Evidence) -> dict[str, float]:
    """Return the settling steps and how many steps the force settles later, at the tolerance where that is least."""
    late = [e.settles(COARSE, "pressure", t) - e.settles(COARSE, "displacement", t) for t in TOLERANCES]
    return steps_of(e, COARSE) | {"force later by at least, steps (0.2 to 8 %)": whole(min(late))}


def stiff_alike(e: Evidence) -> dict[str, float]:
    """Return the difference of settling steps between p = 10E and 100E, at 1 % and at 1e-4."""
    differences: dict[str, float] = {}
    for tolerance, name in ((0.01, "1 %"), (1e-4, "0.01 %")):
        for quantity, word in (("displacement", "displacement"), ("pressure", "contact force")):
            steps = [e.settles(case, quantity, tolerance) for case in (STIFF, STIFFEST)]
            differences[f"{word} to {name}, steps apart"] = whole(abs(steps[1] - steps[0]))
    return differences | {"contact root at 100E": e.number(STIFFEST, "contact.least_root")}


def over_steps(e: Evidence) -> dict[str, float]:
    """Return how xi of the first mode rises with dt at p = 1E below and above Omega = 3.27."""
    pairs = []
    for name, s in MAP.items():
        if s.contact.stiffness == s.block.young:
            pairs.append((s.time.step * e.number(name, "mode1.frequency"), e.number(name, "mode1.damping")))
    omega, xi = np.array(sorted(pairs)).T
    rise = np.diff(xi)
    below = omega[1:] < 3.28
    return {
        "least rise of xi below w dt = 3.27": float(rise[below].min()),
        "least rise of xi above": float(rise[~below].min()),
        "greatest xi": float(xi.max()),
        "at w dt": float(omega[np.argmax(xi)]),
    }


def over_stiffness(e: Evidence) -> dict[str, float]:
    """Return how damping changes with p: first mode below and above dt = 6.2 ms, and contact mode."""
    ladder = (1.0, 10.0, 100.0)
    rises = []
    for dt in {s.time.step for s in MAP.values() if s.time.step <= 0.0062}:
        xi = [e.number(cell(p, dt), "mode1.damping") for p in ladder]
        rises += np.diff(xi).tolist()
    first = [e.number(cell(p, 0.01), "mode1.spectral_radius") for p in ladder]
    return {
        "least rise of xi with p, dt to 6.2 ms": min(rises),
        **{f"|lambda| at dt = 0.01, p = {p:g}E": value for p, value in zip(ladder, first, strict=True)},
        "fall of |lambda| at dt = 0.01": float(-np.diff(first).max()),
        "contact |lambda| at dt = 0.01, p = 100E": e.number(cell(100.0, 0.01), "contact.spectral_radius"),
    }


def small_step(e: Evidence) -> dict[str, float]:
    """Return first and last peak over static, and xi, for the three stiffnesses of Figure 7."""
    values: dict[str, float] = {}
    for case, p in zip(A7, ("1E", "10E", "100E"), strict=True):
        x = e.scaled(case, "displacement")
        values |= {f"first peak at {p}": float(x[: 2 * PEAK].max()), f"last peak at {p}": float(x[-2 * PEAK :].max())}
        values[f"xi at {p}"] = e.number(case, "mode1.damping")
    falls = [values[f"first peak at {p}"] - values[f"last peak at {p}"] for p in ("1E", "10E", "100E")]
    xi = [values[f"xi at {p}"] for p in ("1E", "10E", "100E")]
    return values | {"least fall of the peaks": min(falls), "xi at 100E over 1E": xi[2] / xi[0]}


def average(e: Evidence) -> dict[str, float]:
    """Return what average acceleration damps: both modes' |lambda| - 1, and the ratio measured on the history."""
    return {
        f"|lambda| - 1, {mode} mode": e.number(A8[0], f"{key}.spectral_radius") - 1
        for mode, key in (("first", "mode1"), ("contact", "contact"))
    } | {"measured xi": e.number(A8[0], "mode1.measured_damping")}


def high_frequencies(e: Evidence) -> dict[str, float]:
    """Return |lambda| over w dt, from both modes of the map."""
    pairs = []
    for name, s in MAP.items():
        for mode in ("mode1", "contact"):
            omega = s.time.step * e.number(name, f"{mode}.frequency")
            pairs.append((omega, e.number(name, f"{mode}.spectral_radius")))
    omega, radius = np.array(sorted(pairs)).T
    below = omega < 4
    above = omega > 4
    return {
        "greatest rise of |lambda| below w dt = 4": float(np.diff(radius[below]).max()),
        "least |lambda|": float(radius.min()),
        "greatest w dt of the map": float(omega[-1]),
        "|lambda| there": float(radius[-1]),
        "least rise of |lambda| above w dt = 4": float(np.diff(radius[above]).min()),
    }


def boundary(e: Evidence) -> dict[str, float]:
    """Return alpha - (1/2 + delta)^2 / 4 of both schemes, and how far a stiff contact's roots are from real."""
    cases = named("figure-8")
    margins = [s.time.alpha - (0.5 + s.time.delta) ** 2 / 4 for s in cases.values()]
    root, radius = (e.number(STIFFEST, f"contact.{part}") for part in ("least_root", "spectral_radius"))
    return {
        "margin of (14), average": margins[0],
        "margin of (14), constant": margins[1],
        "1 - |Re|/|lambda| of the stiff contact": 1 - abs(root) / radius,
    }


def discount_alone(e: Evidence) -> dict[str, float]:
    """Return |lambda|^2 / gg and xi at one discount over dt."""
    ratios: dict[str, float] = {}
    squares = []
    for name, s in DISCOUNTS.items():
        ratios[f"xi at dt = {s.time.step:g}"] = e.number(name, "mode1.damping")
        if s.time.step >= 1e-4:
            squares.append(e.number(name, "mode1.spectral_radius") ** 2 / s.time.discount)
    xi = [value for name, value in ratios.items() if name != "xi at dt = 2e-05"]
    return ratios | {
        "|lambda|^2 / gg - 1, largest of complex roots": max(abs(v - 1) for v in squares),
        "xi, greatest over least": max(xi) / min(xi),
    }


def last_discount(e: Evidence) -> dict[str, float]:
    """Return the share of the velocity that each of Figure 9's steps takes away, from |lambda|^2 = gg."""
    shares = [1 - e.number(case, "mode1.spectral_radius") ** 2 for case in A9]
    return {f"discount {i + 1}": share for i, share in enumerate(shares)}


TESTS: Tests = {
    "C1": ((*A34, *A56), equilibrium),
    "C2": ((COARSE,), force_first),
    "C3": ((MIDDLE,), lambda e: steps_of(e, MIDDLE)),
    "C4": ((STIFF,), lambda e: steps_of(e, STIFF)),
    "C5": ((STIFF, STIFFEST), stiff_alike),
    "C6": ([name for name, s in MAP.items() if s.contact.stiffness == s.block.young], over_steps),
    "C7": (MAP, over_stiffness),
    "C8": (A7, small_step),
    "C9": (A8[:1], average),
    "C10": (MAP, high_frequencies),
    "C11": ((STIFFEST,), boundary),
    "C12": (DISCOUNTS, discount_alone),
    "C13": (A9, last_discount),
}
