"""ntdda itself, where a command `ntdda GEOMETRY ANALYSIS` is on PATH: rigid polygons at rest, under their weight.

The program knows lines, which it cuts into blocks, and points: two measured ones tell how a block moves, fixed ones
hold it. Its blocks have one strain, its contacts springs p at corners, p/2.5 along edges; one friction, one material,
gravity 9.81 straight down whatever its input says, constant acceleration with alpha = 1/2, delta = 1.
"""

import math
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from peers.bodies import bodies_of, friction_between
from peers.boxes import named
from peers.packages import command_of
from validation.models.plane.tables import OWN_STEP, OWN_STIFFNESS, PlaneSection

COMMAND = "ntdda"
GRAVITY = (0.0, -9.81)
BEYOND = 1e-3  # of a line, by which its ends go on: the program cuts lines where they cross, and drops what is loose
NEAR = 1e-9  # m and rad: edges on one line
LONGEST = 600.0  # s that a run may last

GEOMETRY = """<?xml version="1.0" standalone="no"?>
<!DOCTYPE DDA SYSTEM "geometry.dtd">
<Berkeley:DDA xmlns:Berkeley="http://www.tsoft.com/~bdoolin/dda">
<Berkeley:Geometry>
<Berkeley:Edgenodedist distance="{near!r}"/>
<Jointlist>
{lines}
</Jointlist>
<Fixedpointlist>
{fixed}
</Fixedpointlist>
<Measuredpointlist>
{measured}
</Measuredpointlist>
</Berkeley:Geometry>
</Berkeley:DDA>
"""
ANALYSIS = """<?xml version="1.0" standalone="no"?>
<!DOCTYPE DDA SYSTEM "analysis.dtd">
<Berkeley:DDA xmlns:Berkeley="http://www.tsoft.com/~bdoolin/dda">
<!-- the program reads no analysis without a comment here -->
<Analysis type="dynamic">
<Analysistype type="dynamic"/>
<Rotation type="linear"/>
<Gravity flag="no"> 9.81 all the same </Gravity>
<Autotimestep flag="no"/>
<Autopenalty flag="no" pfactor="1.0"/>
<Planestrain flag="no"/>
<Numtimesteps timesteps="{steps}"/>
<Maxtimestep maxtimestep="{step!r}"/>
<OCLimit maxopenclose="8"/>
<Maxdisplacement maxdisplacement="0.025"/>
<Saveinterval step="{steps}"/>
<Blockmaterial type="1">
<Unitmass> {density!r} </Unitmass>
<Unitweight> {weight!r} </Unitweight>
<Youngsmod> {young!r} </Youngsmod>
<Poissonratio> 0.0 </Poissonratio>
<Damping>0.0</Damping>
<Istress> 0.0 0.0 0.0 </Istress>
<Ivelocity> 0.0 0.0 0.0 </Ivelocity>
<Istrain> 0.0 0.0 0.0 </Istrain>
</Blockmaterial>
<Jointproperties type="1">
<Friction> {friction!r} </Friction>
<Cohesion> 0.0 </Cohesion>
<Tensile> 0.0 </Tensile>
</Jointproperties>
</Analysis>
</Berkeley:DDA>
"""


def solve(scene):
    """Return position and angle of each block that moves, a value a step of the scene.

    Raises
    ------
    NotImplementedError
        The program is not on PATH, or the scene has what it cannot express.
    """
    blocks = bodies_of(scene)
    plane = scene.table(PlaneSection)
    refused = {
        "gravity other than 9.81 straight down": plane.gravity != GRAVITY,
        "velocities of blocks at t = 0: those of a material": any(
            block.spin or any(block.velocity) for block in blocks
        ),
        "friction by pair": bool(plane.pair),
        "densities by block": len({block.density for block in blocks}) > 1,
        "a stiffness beside rigid blocks": bool(plane.contact and math.isfinite(plane.contact.stiffness)),
        "restitution": bool(plane.contact and plane.contact.restitution is not None),
        "a base that moves": any(block.motion for block in plane.block),
    }
    for what in (name for name, where in refused.items() if where):
        raise NotImplementedError(f"{what}: ntdda has none")
    command = command_of(COMMAND, COMMAND, "a command `ntdda GEOMETRY ANALYSIS` on PATH")
    with tempfile.TemporaryDirectory() as directory:
        place = Path(directory)
        place.joinpath("scene.geo").write_text(geometry(blocks), encoding="utf-8")
        place.joinpath("scene.ana").write_text(analysis(scene, blocks), encoding="utf-8")
        files = [str(place / name) for name in ("scene.geo", "scene.ana")]
        run = subprocess.run([command, *files], cwd=place, capture_output=True, timeout=LONGEST, check=False)
        tables = sorted(place.rglob("*_meas.m"))
        if run.returncode or not tables:
            raise RuntimeError(f"ntdda ended with {run.returncode}, {len(tables)} tables of measured points")
        points = measured_points(tables[0].read_text(encoding="utf-8"))
    moving = [block for block in blocks if not block.held]
    poses = zip(points[::2], points[1::2], moving, strict=True)
    rows = np.array([pose_of(first, second, block, scene) for first, second, block in poses])
    return named(scene, rows.transpose(1, 0, 2), own_steps(scene))


def own_steps(scene):
    """Return how many steps the program makes."""
    return math.ceil(scene.time.duration / OWN_STEP - 1e-9)


def placed(block, points):
    """Return points of a block where they are at t = 0 [m]."""
    cosine = math.cos(block.angle)
    sine = math.sin(block.angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]]) + block.place


def geometry(blocks):
    """Return the lines that cut the blocks out, the points that hold and those that are measured."""
    edges = []
    for block in blocks:
        corners = placed(block, block.corners)
        edges += list(zip(corners, np.roll(corners, -1, axis=0), strict=True))
    lines = []
    for start, end in on_lines(edges):
        on = BEYOND * (end - start)
        lines.append(f'<Joint type="1"> {_text([*(start - on), *(end + on)])} </Joint>')
    fixed = []
    measured = []
    for block in blocks:
        if block.held:
            for part in block.parts:
                corners = placed(block, np.array(part))
                fixed += [f"<Point> {_text((2 * corner + corners.mean(axis=0)) / 3)} </Point>" for corner in corners]
        else:
            inner = placed(block, np.array([[0.0, 0.0], block.corners[0] / 2]))
            measured += [f"<Point> {_text(point)} </Point>" for point in inner]
    size = min(float(np.hypot(*(end - start))) for start, end in edges)
    texts = ("\n".join(part) for part in (lines, fixed, measured))
    return GEOMETRY.format(near=BEYOND * size, **dict(zip(("lines", "fixed", "measured"), texts, strict=True)))


def on_lines(edges):
    """Return edges, those united that lie on one line and touch."""
    united = []
    left = list(edges)
    while left:
        start, end = left.pop()
        along = (end - start) / np.hypot(*(end - start))
        across = np.array([-along[1], along[0]])
        reach = [0.0, float((end - start) @ along)]
        rest = []
        for a, b in left:
            places = sorted((float((a - start) @ along), float((b - start) @ along)))
            off = max(abs(float((point - start) @ across)) for point in (a, b))
            if off < 1e3 * NEAR and places[0] <= reach[1] + NEAR and places[1] >= reach[0] - NEAR:
                reach = [min(reach[0], places[0]), max(reach[1], places[1])]
            else:
                rest.append((a, b))
        grown = (start + reach[0] * along, start + reach[1] * along)
        if len(rest) < len(left):
            left = [*rest, grown]
        else:
            united.append(grown)
    return united


def analysis(scene, blocks):
    """Return material, friction and steps; blocks that are rigid have p over one metre for Young's modulus."""
    density = blocks[0].density
    friction = math.degrees(math.atan(friction_between(scene, 0, 1)))
    steps = own_steps(scene)
    return ANALYSIS.format(
        steps=steps,
        step=scene.time.duration / steps,
        density=density,
        weight=density * -GRAVITY[1],
        young=OWN_STIFFNESS,
        friction=friction,
    )


def measured_points(text):
    """Return the rows of each measured point: step, time, dt, x, y, way, vx, vy, v."""
    points = []
    for part in text.split("measpoint")[1:]:
        numbers = part.partition("[")[2].partition("]")[0].split()
        points.append(np.array(numbers, float).reshape(-1, 9))
    return points


def pose_of(first, second, block, scene):
    """Return x, y and angle of a block at a scene's steps, by its centroid and a second point, shape (steps, 3)."""
    times = scene.time.step * np.arange(1, scene.time.steps + 1)
    if first[-1, 1] < times[-1] * (1 - 1e-6):
        raise RuntimeError(f"ntdda shortened its steps: it came to {first[-1, 1]:g} s of {times[-1]:g}")
    at_start = placed(block, np.array([[0.0, 0.0], block.corners[0] / 2]))
    arm = np.column_stack([second[:, k] - first[:, k] for k in (3, 4)])
    started = math.atan2(*(at_start[1] - at_start[0])[::-1])
    angle = block.angle + np.unwrap([started, *np.arctan2(arm[:, 1], arm[:, 0])])[1:] - started
    columns = [np.interp(times, first[:, 1], values) for values in (first[:, 3], first[:, 4], angle)]
    return np.column_stack(columns)


def _text(numbers):
    return " ".join(f"{float(number):.15g}" for number in numbers)
