"""Cost of sub-blocks: seconds per unknown and step against the direct loop of scikit-fem, and growth with their number.

Both sides run on one thread, by turns; each keeps the minimum of its repeats.

    python reports/bench_subblocks.py [--quick]
"""

from __future__ import annotations

import sys

from bench import PAPER, SQUARE, dda, fem_reference, np

STEPS = 40


def per_unknown(result: dda.Result | fem_reference.Result) -> float:
    """Return the seconds of a step over the number of unknowns."""
    return result.stepping_seconds / STEPS / result.unknowns


def measure(n: int, repeats: int = 3) -> tuple[int, float, float]:
    """Return unknowns of n x n squares, and seconds per unknown and step of squares and of linear elements."""
    model = dda.TwoBlockModel(dda.Block(SQUARE, dda.Material(2700.0, 1e9, 0.25)), dda.Contact(1e9), 5e6)
    system = dda.subdivided(model, n, n, 1e15)
    problem = fem_reference.Problem(
        SQUARE, 0, 2, 2700.0, 1e9, 0.25, "plane stress", 1e9, 1e9, 5e6, elements=n, degree=1, foundation="nodes"
    )
    ours, theirs = [], []
    for _ in range(repeats):
        ours.append(dda.solve_system(system, dda.Scheme(*PAPER), STEPS, full=True))
        theirs.append(fem_reference.solve(problem, fem_reference.Scheme(*PAPER), STEPS, full=True))
    return ours[0].unknowns, min(map(per_unknown, ours)), min(map(per_unknown, theirs))


def main() -> None:
    """Print the table and the fitted growth."""
    counts = (1, 2, 4, 8, 16, 32) if "--quick" in sys.argv else (1, 2, 4, 8, 16, 32, 64)
    print("sub-blocks  unknowns  ns per unknown and step  linear elements  ratio")
    points = []
    for n in counts:
        unknowns, own, other = measure(n)
        points.append((unknowns, own * unknowns))
        print(f"{n * n:>10}  {unknowns:>8}  {1e9 * own:>23.0f}  {1e9 * other:>15.0f}  {own / other:>5.2f}", flush=True)
    x, y = np.log(points[-4:]).T
    print(f"a step grows as the unknowns to the power {np.polyfit(x, y, 1)[0]:.2f} over the last four")


if __name__ == "__main__":
    main()
