"""A block as plain data."""

from __future__ import annotations

from typing import Any, ClassVar

from validation.scenes.plain import PlainHooks, plain
from validation.scenes.scene import Scene
from validation.scenes.tables import BlockSection, ContactSection, LoadSection


class HOOKS(PlainHooks):
    """Outline as width and height, material, contact and loads."""

    tables: ClassVar = {"block": BlockSection, "contact": ContactSection, "load": LoadSection}
    unstated: ClassVar = {
        BlockSection: frozenset({"side", "vertices", "base", "top", "subdivide", "pattern", "glue_ratio"}),
        ContactSection: frozenset(
            {"rule", "damping_ratio", "restitution", "penetration", "rules", "band", "solve_limit", "cut"}
        ),
        LoadSection: frozenset({"ramp", "base_motion"}),
    }
    also = ("block", "contact", "load")
    implied = ("side",)

    def data(self, scene: Scene) -> dict[str, Any]:
        """Return block, contact and load."""
        (left, low), (right, high) = scene.block.outline[0], scene.block.outline[2]
        block = {"width_m": right - left, "height_m": high - low, **self.table(scene.block, "width", "height")}
        contact = self.table(scene.contact) | {"shear_stiffness_N_per_m": plain(scene.contact.shear)}
        geometry = "large rotation" if scene.run.geometry == "updated" else "small"
        return {"block": block, "contact": contact, "load": self.table(scene.load), "geometry": geometry}
