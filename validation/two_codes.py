"""Two finite-element codes of different families on one mesh: scikit-fem and FEniCSx, on one rank and on two."""

from __future__ import annotations

from collections.abc import Iterator

from validation.gates import Gate
from validation.scene import Scene, load_scene
from validation.studies import Study

SCENES = ("two-codes-constant", "two-codes-average")
SAME = 1e-10  # of the maximum
APART = 1e-17  # two programs never agree to the last bit: a smaller difference is a run compared with itself


def cases() -> Iterator[Scene]:
    """Yield the cases of the study."""
    for name in SCENES:
        yield from load_scene(name).expand()


def gates() -> tuple[Gate, ...]:
    """Return the gates: both codes give one history, rounding apart."""
    return tuple(
        Gate(
            scene.name,
            (solver, "fem:full"),
            metric,
            APART,
            SAME,
            "same mesh, degree, quadrature and scheme: what is left is rounding, some eps times the condition of "
            "M + alpha dt^2 K and the steps",
            reference_kind="other code",
        )
        for scene in cases()
        for solver in scene.run.solvers
        if solver != "fem:full"
        for metric in ("displacement.max", "pressure.max")
    )


TWO_CODES = Study(
    name="two-codes",
    title="Two finite-element codes on one mesh",
    purpose="The same mesh, degree and scheme by scikit-fem and by FEniCSx: own nodes, own weak forms, own Newmark "
    "loop, own linear algebra, on one rank and on two.",
    scenes=SCENES,
    gates=gates,
)
