"""Rigid boxes as plain data."""

from __future__ import annotations

from typing import Any, ClassVar

from validation.models.rigid.tables import BoxSection, RigidSection
from validation.scenes.plain import PlainHooks
from validation.scenes.scene import Scene


class HOOKS(PlainHooks):
    """Rigid boxes on a plane, each where it is at t = 0."""

    tables: ClassVar = {"rigid": RigidSection, "rigid.boxes": BoxSection}
    unstated: ClassVar = {BoxSection: frozenset({"x", "lift", "tilt"}), RigidSection: frozenset({"refine"})}

    def data(self, scene: Scene) -> dict[str, Any]:
        """Return the plane and its boxes."""
        rigid = scene.table(RigidSection)
        boxes = []
        for box, (x, y, angle) in zip(rigid.box, rigid.starts, strict=True):
            boxes.append(self.table(box) | {"x_m": x, "y_m": y, "angle_rad": angle})
        return {"rigid": self.table(rigid) | {"boxes": boxes}}
