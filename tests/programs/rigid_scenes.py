"""Scenes of rigid boxes, and what semi-implicit Euler makes of a constant acceleration."""

import numpy as np

from validation.scenes.scene import Scene, parse_scene

BOX = {"width": 1.0, "height": 1.0, "density": 1000.0}


def rigid_scene(*boxes: dict, step: float = 0.01, steps: int = 100, **rigid: object) -> Scene:
    """Return a scene of boxes that differ from `BOX` as they say; rows every `step` seconds."""
    table = {"box": [BOX | box for box in boxes or ({},)], **rigid}
    return parse_scene({"rigid": table, "time": {"step": step, "steps": steps}}, "boxes")


def euler(scene: Scene, own_step: float, velocity: float, acceleration: float) -> np.ndarray:
    """Return the displacement v n h + a h^2 n (n + 1) / 2 at the rows of a scene.

    That is v' = v + h a, x' = x + h v' from rest at x = 0, with n steps of length h up to the row.
    """
    per_row = round(scene.time.step / own_step)
    n = per_row * np.arange(1.0, scene.time.steps + 1)
    return velocity * n * own_step + acceleration * own_step**2 * n * (n + 1) / 2
