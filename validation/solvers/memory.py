"""Memory that a run will take and memory that is there; a scene that cannot fit is refused with the estimate."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from pathlib import Path

from validation.errors import InputError
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver
from validation.solvers.hooks import SolvingHooks

NUMBER = 8  # bytes
COPIES = 4  # of a history while it is made, observed, checked and kept
UNKNOWN = 3000  # bytes of assembly for each unknown: element matrices, indices, M, K and S
FILL = 150  # bytes of the factor for each unknown and doubling of the mesh
REFUSED = "must fit into memory"  # what a refusal says, which is not kept
MODES = 6  # of one block, stepped together
GIGABYTE = 1e9
UNNOTICED = 1e6  # bytes: of so little it is not asked what is left, which takes as long as a step


def sparse(unknowns: float) -> float:
    """Return the bytes of assembly and factor of sparse matrices in the plane."""
    return unknowns * (UNKNOWN + FILL * math.log2(unknowns))


def needed(scene: Scene, solver: Solver) -> tuple[float, str]:
    """Return the bytes that a run will take, and the field that they come from most."""
    steps = float(scene.time.steps) * NUMBER * (COPIES * (len(scene.run.columns) + 1) + MODES)
    model = SolvingHooks.of(scene).memory(scene, solver)
    return steps + model[0], "time.steps" if steps > model[0] else model[1]


def check(scene: Scene, solver: Solver, limit: float = math.inf) -> None:
    """Refuse a scene whose run cannot fit into the memory, or into the bytes that a worker is allowed.

    The `InputError` has the field, the estimate and what is available.
    """
    required_bytes, field = needed(scene, solver)
    if required_bytes <= min(UNNOTICED, limit):
        return
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


# ---- what is there ----


def available() -> float:
    """Return the bytes that can be had without swapping; infinite where the system does not say."""
    return max(0.0, min([_of_machine(), *of_groups(Path("/"))]))


def _of_machine() -> float:
    sizes = _numbers(Path("/proc/meminfo"))
    if "MemAvailable:" in sizes:
        return 1024.0 * sizes["MemAvailable:"]
    try:
        return float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return math.inf


def of_groups(root: Path) -> Iterator[float]:
    """Yield what the control group of this process leaves, and each above it (version 2 of Linux).

    Pages of files can be dropped and do not count as held.
    """
    mount = root / "sys/fs/cgroup"
    for line in _lines(root / "proc/self/cgroup"):
        _, is_unified, group = line.partition("0::/")
        place = mount / group
        for directory in (d for d in (place, *place.parents) if is_unified and d.is_relative_to(mount)):
            limit = min(_number(directory / "memory.max"), _number(directory / "memory.high"))
            if math.isfinite(limit):
                held = _number(directory / "memory.current")
                files = _numbers(directory / "memory.stat").get("inactive_file", 0.0)
                yield limit - (max(0.0, held - files) if math.isfinite(held) else 0.0)


def _lines(path: Path) -> list[str]:
    """Return the lines of a file, none where it cannot be read."""
    try:
        return path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []


def _numbers(path: Path) -> dict[str, float]:
    """Return the second words of a file's lines by the first ones, where they are counts."""
    words = [line.split() for line in _lines(path)]
    return {w[0]: float(w[1]) for w in words if len(w) > 1 and w[1].isdecimal()}


def _number(path: Path) -> float:
    """Return a limit or a size [bytes]; infinite where there is none."""
    text = "".join(_lines(path)).strip()
    return float(text) if text.isdecimal() else math.inf
