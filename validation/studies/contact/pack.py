"""The part of the reference pack on contact that opens: exact motions with their uncertainties, for any code."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from validation.engine.case import Case
from validation.engine.measure import execute
from validation.errors import InputError
from validation.runs.columns import unit_of
from validation.runs.history import History
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.solvers.rigid.impacts import impact_restitution
from validation.studies.bands import cases
from validation.studies.contact.rebound import STIFF
from validation.studies.opening import front
from validation.studies.pack import Part, number

SCENES = ("unlocked", "unlocked-other", "impact", "drop", "bouncing-bar")
COLUMNS = ("displacement", "contact_pressure", "gap_m", "normal_force_m")
SWITCHES = ("first_opening", "first_closing", "second_opening", "second_closing")
ROUNDED = 1e-12  # of a value: the motions are found in 50 digits, the instants and data are those of doubles
OMEGAS = (0.01, 0.03, 0.1, 0.3, 1.0, 2.0, 3.0, 10.0, 100.0, math.inf)
PHASES = tuple(round(0.05 * n, 2) for n in range(21))
FEW = 10  # steps of which each is a number of its own


def write_contact_pack(directory: Path) -> int:
    """Write the part into `contact` of a pack's directory, and return how many numbers it holds.

    Raises
    ------
    InputError
        The directory cannot be made or written.
    """
    part = Part(directory / "contact")
    rows: list[dict[str, Any]] = []
    for scene in cases(*SCENES):
        part.add_scene(scene)
        for motion in scene.run.solvers:
            rows += numbers(scene, motion, part)
    part.add_table("numbers", rows)
    part.add_table("restitution", list(restitutions()))
    part.add_readme(__file__)
    return len(rows)


def numbers(scene: Scene, motion: str, part: Part) -> Iterator[dict[str, Any]]:
    """Run an exact motion, write its history and yield its single numbers.

    Raises
    ------
    InputError
        The motion did not complete.
    """
    sampled_scene = scene.with_values({"run.columns": list(COLUMNS)})
    row, history = execute(Case(sampled_scene, motion), "", "pack")
    if row.outcome is not Outcome.COMPLETED or history is None:
        raise InputError(f"{scene.name} {motion}: {row.outcome.sentence} {'; '.join(row.notes)}")
    part.add_history(scene.name, motion, history)
    values = {name: row.metrics.get(f"switches.{name}") for name in SWITCHES}
    if scene.load.pressure == 0 == scene.load.gravity:
        values["restitution"] = row.metrics.get("contact.restitution")
    for name, value in values.items():
        if isinstance(value, float):
            unit = "1" if name == "restitution" else "s"
            yield number(scene, name, value, unit, ROUNDED * value, motion=motion)
    if scene.time.steps <= FEW:
        yield from _instants(scene, motion, history)


def _instants(scene: Scene, motion: str, history: History) -> Iterator[dict[str, Any]]:
    """Yield the columns at every step; a force at the front of a wave changes within the ulps of its instant."""
    jump = front(scene)
    for name in ("displacement", "contact_pressure"):
        for t, value in zip(history.time, history.columns[name], strict=True):
            front_uncertainty = jump if name == "contact_pressure" else 0.0
            quantity = f"{name} at {float(t)!r} s"
            uncertainty = ROUNDED * abs(float(value)) + front_uncertainty
            yield number(scene, quantity, float(value), unit_of(name), uncertainty, motion=motion)


def restitutions() -> Iterator[dict[str, float]]:
    """Yield the restitution map by scheme, Omega and phase."""
    for alpha, delta in STIFF:
        for omega in OMEGAS:
            for theta in PHASES:
                e = impact_restitution(alpha, delta, 1.0, omega, theta)
                yield {"alpha": alpha, "delta": delta, "omega": omega, "theta": theta, "restitution": e}
