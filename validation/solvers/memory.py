"""Memory that a run will take and memory that is there; a scene that cannot fit is refused with the estimate."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from pathlib import Path

from validation.errors import InputError
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver

NUMBER = 8  # bytes
COPIES = 4  # of a history while it is made, observed, checked and kept
UNKNOWN = 3000  # bytes of assembly for each unknown: element matrices, indices, M, K and S
FILL = 150  # bytes of the factor for each unknown and doubling of the mesh
REFUSED = "must fit into memory"  # what a refusal says; it holds for the moment and is not kept
UNLIMITED = 2.0**60  # bytes: control groups of version 1 say "no limit" as a number next to 2^63
MODES = 6  # of one block, stepped together
GIGABYTE = 1e9


def needed(scene: Scene, solver: Solver) -> tuple[float, str]:
    """Return the bytes that a run will take, and the field that they come from most."""
    steps = float(scene.time.steps) * NUMBER * (COPIES * (len(scene.run.columns) + 1) + MODES)
    if scene.rigid is not None:
        model = 0.0, "rigid.box"
    elif scene.column is not None:
        model = _column(scene, solver)
    else:
        model = _mesh(scene, solver) if solver.meshed else _blocks(scene)
    return steps + model[0], "time.steps" if steps > model[0] else model[1]


def _mesh(scene: Scene, solver: Solver) -> tuple[float, str]:
    """Bytes of assembly and factor of the mesh."""
    if scene.fem.mesh is not None:
        try:
            return 200.0 * Path(scene.fem.mesh).stat().st_size, "fem.mesh"
        except OSError:
            return 0.0, "fem.mesh"  # that it cannot be read is said where it is read
    along = float(scene.fem.degree) * scene.fem.per_side + 1
    uniform = scene.block.poisson == 0 and scene.block.vertices is None and scene.fem.foundation == "distributed"
    saves = solver.saves and scene.fem.cells == "quadrilaterals"
    unknowns = 2 * along if saves and uniform and scene.load.centred else 2 * along * along
    return unknowns * (UNKNOWN + FILL * math.log2(unknowns)), "fem.elements"


def _column(scene: Scene, solver: Solver) -> tuple[float, str]:
    """Bytes of the few diagonals of a column's matrices."""
    blocks = float(sum(layer.blocks for layer in scene.column.layer)) if scene.column else 0.0
    unknowns_of_block = scene.fem.degree * scene.fem.per_side if solver.meshed else 2
    return UNKNOWN * blocks * unknowns_of_block, "column.layer"


def _blocks(scene: Scene) -> tuple[float, str]:
    """Bytes of the dense matrices of sub-blocks."""
    if scene.block.subdivide is None:
        return 0.0, "time.steps"
    along, up = scene.block.subdivide
    unknowns = 6.0 * along * up * (2 if scene.block.pattern == "triangles" else 1)
    return COPIES * NUMBER * unknowns**2, "block.subdivide"


def check(scene: Scene, solver: Solver, limit: float = math.inf) -> None:
    """Refuse a scene whose run cannot fit into the memory, or into the bytes that a worker is allowed.

    Raises
    ------
    InputError
        With the field, the estimate and what is available.
    """
    required_bytes, field = needed(scene, solver)
    available_bytes = min(available(), limit)
    if required_bytes > available_bytes:
        section, _, key = field.partition(".")
        value = getattr(getattr(scene, section), key)
        raise InputError(
            f"{REFUSED}, {solver.name} needs about {required_bytes / GIGABYTE:.3g} GB and "
            f"{available_bytes / GIGABYTE:.3g} GB are available",
            source=scene.name,
            field=field,
            value=value,
        )


# ---- what is there --------------------------------------------------------------------------------------------------


def available() -> float:
    """Return the bytes that can be had without swapping; infinite where the system does not say."""
    return max(0.0, min([_of_machine(), *of_groups(Path("/")), *_of_process()]))


def _of_machine() -> float:
    available_bytes = sizes(Path("/proc/meminfo")).get("MemAvailable")
    if available_bytes is not None:
        return available_bytes
    try:
        return float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return math.inf


def sizes(path: Path) -> dict[str, float]:
    """Return the sizes of a file of lines ``Name: 123 kB``, or ``name 123`` in bytes; none where it cannot be read."""
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return {}
    by_name = {}
    for name, number, *unit in (line.split() for line in lines if len(line.split()) in (2, 3)):
        if number.isdecimal():
            by_name[name.rstrip(":")] = int(number) * (1024.0 if unit == ["kB"] else 1.0)
    return by_name


# ---- control groups -------------------------------------------------------------------------------------------------


def of_groups(root: Path) -> Iterator[float]:
    """Yield what each control group of this process leaves, of version 2 and of version 1, up to the root's."""
    for controllers, group in _groups(root):
        limits = ["memory.max", "memory.high"]
        used = "memory.current"
        mount = root / "sys/fs/cgroup"
        if controllers:
            limits = ["memory.limit_in_bytes"]
            used = "memory.usage_in_bytes"
            mount = mount / "memory"
        if controllers and "memory" not in controllers.split(","):
            continue
        place = mount / group.lstrip("/")
        for directory in (d for d in (place, *place.parents) if d.is_relative_to(mount)):
            limit = min((_number(directory / name) for name in limits), default=math.inf)
            if limit < UNLIMITED:
                yield limit - _unreclaimable(directory, used)


def _groups(root: Path) -> list[tuple[str, str]]:
    """Return the controllers and the path of each group that this process is in."""
    try:
        lines = (root / "proc/self/cgroup").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []
    parts = [line.split(":", 2) for line in lines]
    return [(part[1], part[2]) for part in parts if len(part) == 3]


def _unreclaimable(directory: Path, used: str) -> float:
    """Return the bytes that a group holds and cannot give back: its files' pages can be dropped."""
    current = _number(directory / used)
    statistics = sizes(directory / "memory.stat")
    files = statistics.get("total_inactive_file", statistics.get("inactive_file", 0.0))
    return max(0.0, current - files) if math.isfinite(current) else 0.0


def _number(path: Path) -> float:
    """Return a limit or a size [bytes]; infinite where there is none."""
    try:
        text = path.read_text(encoding="ascii").strip()
        return math.inf if text == "max" else float(text)
    except (OSError, ValueError):
        return math.inf


# ---- limits of the process ------------------------------------------------------------------------------------------


def _of_process() -> Iterator[float]:
    """Yield what the limits of the address space and of the data leave (``ulimit -v`` and ``-d``)."""
    try:
        import resource
    except ImportError:
        return
    sizes_in_use = sizes(Path("/proc/self/status"))
    for limit, field in ((resource.RLIMIT_AS, "VmSize"), (resource.RLIMIT_DATA, "VmData")):
        soft = resource.getrlimit(limit)[0]
        if soft != resource.RLIM_INFINITY:
            yield soft - sizes_in_use.get(field, 0.0)
