"""Siconos: nonsmooth dynamics, as two solvers: with settings chosen for accuracy, and as it comes.

Matrices are made here and in `siconos_column`, and go as JSON to `siconos_program`, which Debian's Python runs with
the package `siconos`: every step of time, every complementarity problem and every impact is Siconos'.
"""

import json
import math
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from peers.blocks import push_of, tangent_of, turn_of
from peers.programs import ExternalProgram

PYTHON = "/usr/bin/python3"  # Debian's, for which its packages are made
PROGRAM = Path(__file__).with_name("siconos_program.py")
RECIPE = "Debian: apt-get install python3-siconos"
ABSENT = 3  # exit status of the program's side where there is no Siconos
MOST = 20_000  # steps of a run that settings for accuracy may choose
RADIANS = 0.02  # of the fastest vibration in a step, settings for accuracy
VISCOUS = 1e-6  # of the friction's complementarity: what makes its matrix definite, see `complementarity`
GLUED = 1e3  # tan(phi) of a corner that does not slip while it is closed
SOFT = 1e-3  # of the block's height: weight on springs or in the block from which it is not taken as rigid


class Siconos(ExternalProgram):
    """Siconos with settings chosen for accuracy."""

    program = "Siconos"
    recipe = RECIPE
    fine = True
    handles = frozenset(  # words of validation.scenes.features
        (
            *("off-centre load", "own weight", "unilateral contact", "friction", "slope", "large rotation", "column"),
            *("implicit contact", "energy-conserving contact"),  # rules of DDA's step, of which nothing is used here
            *("blocks in the plane", "blocks that move"),
        )
    )
    model = "block of one strain by its matrices; contact springs as a linear complementarity system; boxes are rigid"
    settings = (
        "MoreauJeanOSI, EulerMoreauOSI, theta = gamma = 1/2; 0.02 rad of the fastest vibration a step; rigid boxes at "
        "1 ms, relations at the middle of the step, Lemke's pivots, piles up to 100 000 iterations"
    )

    def version(self):
        """Return the version of Debian's package, or that there is none."""
        try:
            command = ["dpkg-query", "-W", "-f", "${Version}", "python3-siconos"]
            return subprocess.run(command, capture_output=True, text=True).stdout or "not installed"
        except OSError:
            return "unknown"

    def solve(self, scene):
        """Return the columns of a scene that the model has.

        Raises
        ------
        NotImplementedError
            The scene is not what Siconos is asked here, or it is not installed.
        ArithmeticError
            Its complementarity solver failed in some steps.
        """
        if "plane" in scene.tables():
            from peers.siconos_boxes import boxes

            return boxes(scene, self.fine, ask)
        if scene.time.discount != 1:
            raise NotImplementedError("time.gg: the discount of velocities is a device of DDA's own scheme")
        found = (column if scene.column is not None else block)(scene, self.fine)
        return {name: found[name] for name in scene.run.columns if name in found}


class AsItComes(Siconos):
    """Siconos with its own integrator and contact at the step of the problem."""

    fine = False
    model = "the same block on locked springs; contact is Siconos' own, rigid, without stiffness"
    settings = (
        "MoreauJeanOSI(), theta = 1/2, and FrictionContact(2) at the step of the scene; rigid boxes at 0.5 ms, the "
        "step of MechanicsHdf5Runner.run"
    )


def ask(request):
    """Run the program's side and return its answer, arrays of one row for each step of the scene.

    Raises
    ------
    NotImplementedError
        Siconos is not installed.
    ArithmeticError
        It ended before its answer, or its solver failed.
    """
    if not Path(PYTHON).exists():
        raise NotImplementedError(f"Siconos is not installed: {RECIPE}")
    one = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PATH": "/usr/bin:/bin"}
    with tempfile.TemporaryDirectory() as place:
        given, answer = Path(place, "request.json"), Path(place, "answer.json")
        given.write_text(json.dumps(request, default=lambda value: np.asarray(value).tolist()))
        command = [PYTHON, "-I", str(PROGRAM), str(given), str(answer)]  # -I: this folder would hide the package
        done = subprocess.run(command, capture_output=True, text=True, cwd=place, env=one)
        if done.returncode == ABSENT:
            raise NotImplementedError(f"Siconos is not installed: {RECIPE}")
        failed = done.stdout.count("Non smooth solver warning")
        if done.returncode or failed:
            last = (done.stderr.strip().splitlines() or ["without a word"])[-1]
            raise ArithmeticError(f"Siconos: {f'its solver failed in {failed} steps' if failed else last}")
        return {name: np.asarray(value) for name, value in json.loads(answer.read_text()).items()}


def substeps(scene, rate, fine):
    """Return the number of steps in one of the scene's, from the fastest rate of the model [rad/s]."""
    wanted = math.ceil(scene.time.step * rate / RADIANS) if fine else 1
    return max(1, min(wanted, MOST // scene.time.steps))


def block(scene, fine):
    """Run a block and return all its columns."""
    sizes = scene.block.rectangle
    if sizes is None:
        raise NotImplementedError("block.vertices: the block must be an upright rectangle on its lower edge")
    if scene.contact.law == "locked":
        return locked(scene, *sizes, fine)
    if scene.run.geometry == "updated" or not fine:
        return pile(scene, *sizes, fine)
    return springs(scene, *sizes)


def matrices(scene, a, h):
    """Return mass, stiffness, load and the rows of the corners in (u, v, ux, uy, vx, vy), with x, y from the centroid.

    M = m diag(1, 1, a^2/12, h^2/12, a^2/12, h^2/12) [kg, kg m2], shape (6,); K = a h S' D S [N/m, N m], shape (6, 6);
    F [N, N m], shape (6,); gaps w = v(x, -h/2) and slides s = u(x, -h/2) of the two corners, shape (2, 6) [-, m].
    """
    b, load = scene.block, scene.load
    m, mu, slope = b.density * a * h, b.poisson, math.radians(load.slope)
    if b.hypothesis == "plane strain":
        material = np.array([[1 - mu, mu, 0], [mu, 1 - mu, 0], [0, 0, 0.5 - mu]]) / ((1 + mu) * (1 - 2 * mu))
    else:
        material = np.array([[1, mu, 0], [mu, 1, 0], [0, 0, (1 - mu) / 2]]) / (1 - mu * mu)
    strain = np.array([[0, 0, 1, 0, 0, 0], [0, 0, 0, 0, 0, 1], [0, 0, 0, 1, 1, 0.0]])
    pressed = push_of(scene)
    dragged = load.traction * a
    fx, fy = m * load.gravity * math.sin(slope) + dragged, -m * load.gravity * math.cos(slope) - pressed
    return {
        "M": m * np.array([1, 1, a * a / 12, h * h / 12, a * a / 12, h * h / 12]),
        "K": b.young * a * h * strain.T @ material @ strain,
        "F": np.array([fx, fy, 0, dragged * h / 2, -pressed * load.eccentricity, -pressed * h / 2]),
        "gap": np.array([[0, 1, 0, 0, x, -h / 2] for x in (-a / 2, a / 2)]),
        "slide": np.array([[1, 0, x, -h / 2, 0, 0] for x in (-a / 2, a / 2)]),
    }


def fastest(of, stiffness):
    """Return the highest natural frequency [rad/s]."""
    root = np.sqrt(of["M"])
    return math.sqrt(float(np.linalg.eigvalsh(stiffness / np.outer(root, root))[-1]))


def columns_of(q, pressure):
    """Return the columns of histories of the six unknowns, shape (steps, 6)."""
    turned = (q[:, 4] - q[:, 3]) / 2
    moved = {"displacement": q[:, 1], "horizontal_displacement": q[:, 0], "rotation": turned}
    return {**moved, "contact_pressure": pressure}


def locked(scene, a, h, fine):
    """Run a block on springs that push and pull: M q'' + K q = F by Moreau and Jean's theta method."""
    of, p, ps = matrices(scene, a, h), scene.contact.stiffness, scene.contact.shear
    K = of["K"] + p * of["gap"].T @ of["gap"] + ps * of["slide"].T @ of["slide"]
    more = {"M": np.diag(of["M"]), "K": K, "C": np.zeros((6, 6)), "load": of["F"], "signal": None}
    q = ask({"kind": "linear", **times(scene, substeps(scene, fastest(of, K), fine)), **more})["q"]
    return columns_of(q, -p * (q @ of["gap"].T).sum(axis=1) / a)


def times(scene, parts):
    """Return what every request says of time."""
    return {"step": scene.time.step / parts, "parts": parts, "steps": scene.time.steps}


def springs(scene, a, h):
    """Run a block on springs without tension; the pressure is that of its own springs at the ends of the steps.

    Raises
    ------
    NotImplementedError
        A corner with cohesion opened: the complementarity system keeps the cohesion that the scene takes away.
    """
    c = scene.contact
    of = matrices(scene, a, h)
    K = of["K"] + c.stiffness * of["gap"].T @ of["gap"] + c.shear * of["slide"].T @ of["slide"]
    parts = substeps(scene, fastest(of, K), True)
    found = ask({"kind": "complementarity", **times(scene, parts), **complementarity(scene, of, a, parts)})
    if c.cohesion and found["opened"]:
        raise NotImplementedError("contact.cohesion: is lost where a corner opens, which complementarity cannot say")
    q = found["x"][:, :6]
    return columns_of(q, c.stiffness * np.maximum(0.0, -(q @ of["gap"].T) - c.gap).sum(axis=1) / a)


def complementarity(scene, of, a, parts):
    """Return x' = A x + b + B l, y = C x + D l + e, 0 <= y perp l >= 0 with x = (q, q', r), lengths in units of d.

    Of each corner y = w + N/p with l = N/p, and, where it rubs, two y = (tan(phi) N + C -+ p_s (s - r)) / p_s with the
    rates of slip r' = l1 - l2; a step's slip is the unit of l1, l2. Their block of the matrix is singular; `VISCOUS`
    on its diagonal, a resistance p_s dt VISCOUS r', is what Lemke's pivots need. Without friction, a closed corner is
    glued by a friction of `GLUED`, and its rows hold at the ends of the steps (from row `ends` on).
    """
    c, step = scene.contact, scene.time.step / parts
    p, ps, mass = c.stiffness, c.shear, of["M"][:, None]
    rubs = ps > 0
    tan = tangent_of(scene, GLUED)
    d = float(np.abs(of["F"][:2]).sum()) / (2 * p) + abs(scene.block.velocity) * math.sqrt(of["M"][0] / (2 * p)) or 1.0
    n, size = (6, 14) if rubs else (2, 12)
    A, B, C, D = np.zeros((size, size)), np.zeros((size, n)), np.zeros((n, size)), np.eye(n)
    A[:6, 6:12] = np.eye(6)
    A[6:12, :6] = -(of["K"] + ps * of["slide"].T @ of["slide"]) / mass
    B[6:12, :2], C[:2, :6] = p * d * of["gap"].T / mass, of["gap"] / d
    e = np.full(n, c.gap / d)
    if rubs:
        A[6:12, 12:] = ps * d * of["slide"].T / mass
        both = np.array([[1.0, 0.0], [0.0, 1.0]])
        B[12:, 2:] = np.hstack([both, -both]) / step
        C[2:, :6], C[2:, 12:] = np.vstack([-of["slide"], of["slide"]]) / d, np.vstack([both, -both])
        D[2:, :2], D[2:, 2:] = tan * p / ps * np.vstack([both, both]), VISCOUS * np.eye(4)
        e[2:] = a * c.cohesion / 2 / (ps * d)
    x0, b = np.zeros(size), np.zeros(size)
    x0[7], b[6:12] = scene.block.velocity, of["F"] / of["M"]
    ends = 2 if c.friction is None else n
    return {"A": A, "B": B, "C": C, "D": D, "b": b, "e": e, "x0": x0, "ends": ends}


def pile(scene, a, h, fine):
    """Run a rigid block on two rigid corners; where the geometry is updated, its rotation is not small."""
    c, turns = scene.contact, scene.run.geometry == "updated"
    of = matrices(scene, a, h)
    force = of["F"][[0, 1, 4]] - [0, 0, of["F"][3]]
    refuse_rigid(scene, force, h)
    tan = tangent_of(scene, GLUED)
    tilt = math.radians(scene.block.tilt)
    mass = float(of["M"][0])
    corners = np.array([[-a / 2, -h / 2], [a / 2, -h / 2]])
    down = turn_of(tilt) @ corners[1 if tilt < 0 else 0]
    start = [-down[0], -down[1], tilt]
    parts = substeps(scene, 40 * math.sqrt(np.hypot(*force[:2]) / mass / h), fine)
    inertia = [mass, mass, of["M"][2] + of["M"][3]]
    body = {"inertia": inertia, "q0": start, "v0": np.zeros(3), "couple": force[2]}
    motion = {"boxes": [body], "pull": force[:2] / mass, "amplitude": 0.0, "rate": 0.0, "turns": turns, "middle": fine}
    law = {"restitution": 0.0, "friction": tan if c.shear > 0 else 0.0, "pivots": False, "iterations": None}
    touching = [corner_on_ground(corner) for corner in corners]
    request = {**motion, **law, "contacts": touching, "size": 0.0}  # of no size: a gap is taken as it is
    q = ask({"kind": "boxes", **times(scene, parts), **request})["poses"][:, 0]
    return {"horizontal_displacement": q[:, 0] - start[0], "rotation": q[:, 2] - tilt}


def corner_on_ground(corner):
    """Return the contact of a corner of the lowest body with the ground."""
    return {"body": 0, "corner": corner, "other": None, "level": 0.0, "outward": 1.0, "carried": 0}


def refuse_rigid(scene, force, h):
    """Refuse what a rigid block on Siconos' own contact cannot be asked."""
    c, load, turns = scene.contact, scene.load, scene.run.geometry == "updated"
    asked = [name for name in scene.run.columns if name not in ("horizontal_displacement", "rotation")]
    if asked:
        raise NotImplementedError(f"{asked[0]}: is that of contact springs, and Siconos' own contact is rigid")
    if c.gap or scene.block.velocity:
        raise NotImplementedError("contact.gap, block.velocity: the scene has springs, a rigid impact a restitution")
    if c.cohesion:
        raise NotImplementedError("contact.cohesion: Siconos' law of Coulomb friction has none")
    if turns and (load.pressure or load.traction):
        raise NotImplementedError("load: pressure and traction on a block that turns are not given to the rigid body")
    if force[1] >= 0:
        raise NotImplementedError("load: nothing presses the block on its contact, which is taken as rigid")
    compression = -force[1] * max(1 / c.stiffness, h / (scene.block.young * scene.block.base_length)) / h
    if compression > SOFT:
        raise NotImplementedError("contact.stiffness, block.young: too soft for a block and contact taken as rigid")
    held = c.shear > 0 and (c.friction is None or abs(force[0]) <= math.tan(math.radians(c.friction)) * -force[1])
    if held and not turns:
        raise NotImplementedError("contact: friction holds the block, and what moves it are springs, not rigid corners")


def column(scene, fine):
    """Run a column and return its displacements."""
    from peers.siconos_column import Chain

    chain = Chain.of(scene, fine)
    found = ask({"kind": "linear", **times(scene, chain.parts), **chain.request()})
    return chain.columns(scene.column.heights, found["q"])
