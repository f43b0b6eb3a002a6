"""Blocks that move in the plane as plain data: what any program needs to place them, and the law of their contact."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from validation.errors import InputError
from validation.models.plane.blocks import PlacedBlock, PlaneBlockSection, second_moments
from validation.models.plane.joints import PlaneContactSection, PlaneTouchSection
from validation.models.plane.tables import BODIES, PlaneSection
from validation.scenes.plain import PlainHooks
from validation.scenes.record import read_record
from validation.scenes.scene import Scene

STATED = {"name", "density", "velocity", "spin", "fixed", "young", "poisson"}
SHAPES = frozenset(PlaneBlockSection.model_fields) - STATED


class HOOKS(PlainHooks):
    """Blocks, each where it is at t = 0, that touch by the law of their pair under their weight."""

    tables: ClassVar = {
        "plane.blocks": PlaneBlockSection,
        "plane.contact": PlaneContactSection,
        "plane.touches": PlaneTouchSection,
    }
    unstated: ClassVar = {PlaneBlockSection: SHAPES}

    def data(self, scene: Scene) -> dict[str, Any]:
        """Return blocks, contacts and gravity; null where there is no law, no pair with its own, no stated contact.

        A scene with more than that is an `InputError`.
        """
        plane = scene.table(PlaneSection)
        if more := [name for name in (*BODIES, "observe", "bond", "load", "ramp") if getattr(plane, name)]:
            rule = "plain data hold blocks and contacts under weight"
            raise InputError(rule, source=scene.name, field=f"plane.{more[0]}")
        blocks = plane.assembly.blocks
        pairs = []
        for (first, second), springs in plane.assembly.springs_of_pairs.items():
            pairs.append({"blocks": [blocks[first].name, blocks[second].name], "contact": self.table(springs)})
        return {
            "plane": {
                "gravity_m_per_s2": list(plane.gravity),
                "contact": plane.contact and self.table(plane.contact),
                "pairs": pairs or None,
                "touches": [self.table(touch) for touch in plane.touch] or None,
                "blocks": [_block(block) for block in blocks],
            }
        }


def _block(block: PlacedBlock) -> dict[str, Any]:
    """Return a block of unit depth: its outline and its centroid at t = 0, and what moves it from there."""
    mass = block.mass
    record = None if block.motion is None else read_record(Path(block.motion))
    rows = (
        None if record is None else {"time_s": record.time.tolist(), "x_m": record.x.tolist(), "y_m": record.y.tolist()}
    )
    return {
        "name": block.name,
        "fixed": block.fixed,
        "motion": rows,
        "vertices_m": [list(corner) for corner in block.vertices],
        "centroid_m": list(block.centroid),
        "angle_rad": block.angle,
        "young_Pa": None if math.isinf(block.young) else block.young,
        "poisson": None if math.isinf(block.young) else block.poisson,
        "density_kg_per_m3": block.density,
        "mass_kg": mass,
        "inertia_kg_m2": block.density * float(np.trace(second_moments(block.vertices))),
        "velocity_m_per_s": list(block.velocity),
        "spin_rad_per_s": block.spin,
    }
