"""What Yade is given and how it is run: rigid bodies with contact points, bonds between them, a floor, a drive."""

import json
import math
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from peers.packages import command_of
from peers.yade_program import ANSWER, REQUEST

RECIPE = "apt-get install yade"
LONGEST = 280.0  # s of a run


@dataclass(frozen=True)
class Point:
    """A sphere of a body: with the floor, or for a bond."""

    at: tuple[float, float]  # of its centre, from the body's centre [m]
    radius: float  # [m]
    touches: bool = True  # whether it meets the floor


@dataclass(frozen=True)
class Body:
    """A rigid body in the plane."""

    at: tuple[float, float]  # centre [m]
    mass: float  # [kg]
    points: tuple[Point, ...]
    inertia: float = 0.0  # about z [kg m2]; 0: it does not turn
    velocity: float = 0.0  # upwards at t = 0 [m/s]
    force: tuple[float, float] = (0.0, 0.0)  # from t = 0 on [N]
    torque: float = 0.0  # counter-clockwise [N m]
    fixed: bool = False


@dataclass(frozen=True)
class Bond:
    """Springs between the first of two bodies' points, which never break; the upper body comes second."""

    bodies: tuple[int, int]
    points: tuple[int, int]
    normal: float  # [N/m]
    shear: float  # [N/m]
    bending: float = 0.0  # [N m]


@dataclass(frozen=True)
class Floor:
    """A plane that the points stand on."""

    height: float  # [m]
    normal: float  # of a point [N/m]
    shear: float  # [N/m]
    friction: float  # [rad]
    cohesion: float = 0.0  # of a point [N]
    holds: bool = False  # whether it also pulls, and nothing slips


@dataclass(frozen=True)
class Drive:
    """What drives a chain of bodies along one axis, at each explicit step."""

    axis: int  # 0: x, 1: y
    top: list[float]  # force on the last body [N]
    ground: list[float] = field(default_factory=list)  # displacement of the first body [m]
    incident: list[float] = field(default_factory=list)  # velocity of the wave that comes up to the first body [m/s]
    impedance: float = 0.0  # of the dashpot below the first body [N s/m]


@dataclass(frozen=True)
class Model:
    """What Yade is given."""

    bodies: tuple[Body, ...]
    bonds: tuple[Bond, ...] = ()
    floor: Floor | None = None
    gravity: tuple[float, float] = (0.0, 0.0)  # [m/s2]

    def highest(self):
        """Return an upper bound of the highest frequency [rad/s], from twice the rows of M^-1 K (Gershgorin)."""
        rows = np.zeros(len(self.bodies))
        for bond in self.bonds:
            for i, k in zip(bond.bodies, bond.points, strict=True):
                point = self.bodies[i].points[k]
                rows[i] += self._softness(i, math.hypot(*point.at) + point.radius, bond)
        for i, body in enumerate(self.bodies):
            for point in body.points:
                if self.floor is not None and point.touches:
                    rows[i] += self._softness(i, math.hypot(*point.at), self.floor)
        return math.sqrt(2 * float(rows.max()))

    def _softness(self, i, lever, springs):
        """Return the stiffness of springs on a body over its mass and inertia [1/s2]."""
        body, most = self.bodies[i], max(abs(springs.normal), springs.shear)
        if body.fixed:
            return 0.0
        bending = springs.bending if isinstance(springs, Bond) else 0.0
        return most / body.mass + ((most * lever**2 + bending) / body.inertia if body.inertia else 0.0)


@dataclass(frozen=True)
class Motion:
    """What Yade answers: one row for each step of the scene, one column for each body."""

    x: np.ndarray  # [m]
    y: np.ndarray  # [m]
    turn: np.ndarray  # [rad]
    force: np.ndarray  # of the floor, or of what is below the first body, on what stands on it [N], shape (steps,)


def version():
    """Return the program's version, as it says it itself."""
    program = shutil.which("yade")
    if program is None:
        return "not installed"
    said = subprocess.run([program, "--version"], capture_output=True, text=True, timeout=60, check=False).stdout
    return next((line.split()[-1] for line in said.splitlines() if "version" in line.lower()), said.strip())


def run(request):
    """Run the program in a directory of its own and return its answer.

    Raises
    ------
    NotImplementedError
        It is not installed.
    RuntimeError
        It gave no answer.
    """
    program = command_of("yade", "Yade", RECIPE)
    with tempfile.TemporaryDirectory() as directory:
        script = Path(directory) / "bodies_and_bonds.py"  # a script named yade.py would stand in for the package
        script.write_text((Path(__file__).parent / "yade_program.py").read_text())
        (script.parent / REQUEST).write_text(json.dumps(request))
        kept = {name: text for name, text in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_ENV"))}
        command = [program, "-n", "-x", "-j1", script.name]
        done = subprocess.run(
            command,
            cwd=directory,
            env=kept,
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
            check=False,
            timeout=LONGEST,
        )
        if not (script.parent / ANSWER).exists():
            raise RuntimeError(f"yade gave no answer: {(done.stderr or done.stdout)[-300:]}")
        return json.loads((script.parent / ANSWER).read_text())
