"""The study of sub-blocks: what cutting a block into glued sub-blocks buys, and how rocking differs by model."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from validation.gates.gate import Gate
from validation.scenes.scene import Scene
from validation.studies.bands import APART, OTHER, OWN, cases, gate, near
from validation.studies.declaration import Study
from validation.theory import spectra, statics

SCENES = (
    "subblocks-column",
    "subblocks-glue",
    "subblocks-triangles",
    "subblocks-axial",
    "subblocks-rocking",
    "subblocks-locking",
    "subblocks-best-glue",
    "rocking",
)
SAME = 1e-8  # of the maximum: what stiff glue must reach

# Relative error of the first frequency of 32 x 32 stiffly glued squares: an independent experiment, two digits.
LOCKING = (  # (p / E, mu) -> value, half a unit of its last digit
    ((1.0, 0.0), 0.16, 0.005),
    ((100.0, 0.0), 0.55, 0.005),
    ((1.0, 0.25), 0.0025, 0.00005),
    ((100.0, 0.25), 0.025, 0.0005),
)
# Relative errors of the first frequency against quadratic elements, this suite's own last values.
TRIANGLES = {("axial", 4): 0.00387, ("axial", 8): 0.001165, ("rocking", 4): 0.0674, ("rocking", 8): 0.0185}
BEST_GLUE = {"axial": -0.0292, "rocking": 0.0280}  # squares, n = 8, p = 1E, glue_ratio = 3


def gates() -> tuple[Gate, ...]:
    """Return all gates of the study."""
    return (*column(), *glue(), *triangles(), *convergence(), *locking(), *best_glue(), *rocking())


def column() -> Iterator[Gate]:
    """Yield the gates on a column: linear elements on the same n, and so of second order against the bar."""
    same = (
        "affine sub-blocks that meet in joints of 1e12 E are linear elements: what is left is the joints' "
        "compliance, (n - 1) / 2e12 of the column's, and rounding"
    )
    order = "linear elements overestimate by (b/n)^2 / 24, order 2; a tenth for the next order"
    for scene in cases("subblocks-column"):
        for metric in ("displacement.max", "pressure.max"):
            yield gate(scene, ("dda", "fem"), metric, (APART, SAME), same, OTHER)
        if scene.fem.per_side >= 4:
            error = spectra.mesh_frequency_error(scene)
            yield gate(scene, ("dda", "bar"), "mode1.frequency", (0.9 * error, 1.1 * error), order)


def glue() -> Iterator[Gate]:
    """Yield the gates on the floor that finite glue leaves: joints in series."""
    why = "n - 1 joints in series, 1 / (2 glue_ratio E) each, half of them below the middle; band: rounding"
    for scene in cases("subblocks-glue"):
        band = near(glued_column(scene), 1e4 * spectra.EPS)
        yield gate(scene, "dda", "displacement.static", band, why)


def glued_column(scene: Scene) -> float:
    """Return the static v of the centroid of a glued column, mu = 0 [m]: block on springs, and its joints."""
    width, _ = statics.size(scene)
    _, n = scene.block.subdivide or (1, 1)
    joint = 1 / (2 * scene.block.glue_ratio * scene.block.young)
    return statics.static_displacement(scene) - (n - 1) / 2 * joint * scene.load.pressure * width


def triangles() -> Iterator[Gate]:
    """Yield the gates on glued triangles: linear finite elements on the same mesh and the same point springs."""
    why = (
        "triangles glued at 1e12 E are constant-strain finite elements: what is left is the joints' compliance and "
        "rounding"
    )
    for scene in cases("subblocks-triangles"):
        for quantity in ("displacement", "pressure", "horizontal", "rotation"):
            yield gate(scene, ("dda", "fem"), f"{quantity}.max", (APART, SAME), why, OTHER)


def convergence() -> Iterator[Gate]:
    """Yield the gates on triangles against quadratic elements: both first frequencies converge."""
    why = (
        "constant-strain elements converge: the error falls nearly fourfold from n = 4 to 8; band 2 %: another "
        "elimination order does not move it, a softer spring does"
    )
    for kind in ("axial", "rocking"):
        for scene in cases(f"subblocks-{kind}"):
            n = (scene.block.subdivide or (1, 1))[0]
            if scene.block.pattern == "triangles" and (kind, n) in TRIANGLES:
                band = near(TRIANGLES[kind, n], 0.02)
                yield gate(scene, ("dda", "fem"), "mode1.frequency", band, why, OWN)


def locking() -> Iterator[Gate]:
    """Yield the gates on squares that lock."""
    numbers = {key: (value, half) for key, value, half in LOCKING}
    why = (
        "affine squares that meet at their corners only move as u = f(x) + g(y): physics, not convergence; "
        "independent experiment, half a unit of its last digit, and (b/n)^2 / 24 of linear elements at n = 32"
    )
    for scene in cases("subblocks-locking"):
        b = scene.block
        value, half = numbers[scene.contact.stiffness / b.young, b.poisson]
        wave = spectra.bar_frequency(scene) / (b.young / b.density) ** 0.5 * statics.size(scene)[1]
        edges = value - half, value + half + (wave / 32) ** 2 / 24
        yield gate(scene, ("dda", "fem"), "mode1.frequency", edges, why, uncertainty=half)


def best_glue() -> Iterator[Gate]:
    """Yield the gates on the glue that shares the error of squares between both motions."""
    why = "soft glue gives way in rows, stiff glue locks them: near glue_ratio = 3 both errors are 3 %; band 2 %"
    for scene in cases("subblocks-best-glue"):
        if scene.block.glue_ratio == 3.0:
            band = near(BEST_GLUE["rocking" if scene.load.traction else "axial"], 0.02)
            yield gate(scene, ("dda", "fem"), "mode1.frequency", band, why, OWN)


def rocking() -> Iterator[Gate]:
    """Yield the gates on the rocking frequency of the whole block, which no patch width brings together."""
    lowest = "lowest root of the textbook matrices (17) and (27) in (u, r, gxy); band: rounding"
    softer = (
        "independent program: 137 rad/s on the whole base, at most about 150 on any patches, where the block "
        "on corner springs has 226: p a^2 / 2 against p a^2 / 6 in rocking"
    )
    bands = {1.0: (136.5, 137.5), 0.4: (149.5, 151.5)}
    for scene in cases("rocking"):
        yield gate(scene, "dda", "mode1.frequency", near(rocking_frequency(scene), 1e-12), lowest)
        if (band := bands.get(scene.fem.patch_width or 0.0)) is not None:
            yield gate(scene, "fem", "mode1.frequency", band, softer, uncertainty=1.0)


def rocking_frequency(scene: Scene) -> float:
    """Return the lowest frequency of a DDA square at mu = 0 that turns and shears [rad/s].

    (17): M = rho diag(a^2, a^4/6, a^4/24); (27): p [[2, a, -a/2], [a, a^2, 0], [-a/2, 0, a^2/4]], and A G for gxy.
    """
    a = statics.size(scene)[0]
    p = scene.contact.stiffness
    M = scene.block.density * np.array([a**2, a**4 / 6, a**4 / 24])
    K = p * np.array([[2.0, a, -a / 2], [a, a * a, 0.0], [-a / 2, 0.0, a * a / 4]])
    K[2, 2] += a * a * scene.block.young / 2
    root = np.sqrt(M)
    return float(np.sqrt(np.linalg.eigvalsh(K / root / root[:, None])[0]))


SUBBLOCKS = Study(
    name="subblocks",
    title="The block cut into sub-blocks, and loads that turn it",
    purpose="A single block has one strain. Cut into sub-blocks that are glued by stiff springs it converges, or it "
    "locks: columns and triangles are linear finite elements in the limit, squares are not. Sideways loads set the "
    "block rocking, which corner springs and a foundation resist differently.",
    scenes=SCENES,
    gates=gates,
)
