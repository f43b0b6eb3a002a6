"""The kind of a block: its tables, and how they go together."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from validation.scenes.kinds import Kind
from validation.scenes.tables import BlockSection, ContactSection, LoadSection


class Block(Kind):
    """One block under a load, on a contact."""

    name = "block"
    words = "a block"
    locks_contact = True
    point = "centroid"
    rank = 0.0
    tables: ClassVar = {"block": BlockSection, "contact": ContactSection, "load": LoadSection}

    def check(self, scene: Any) -> None:
        """Check lengths of load and springs against those of the block, and the scheme of a rule of contact."""
        width = scene.fem.patch_width
        if width is not None and width > scene.block.base_length / 2:
            rule = f"must be at most half the base length {scene.block.base_length / 2:g}"
            raise ValueError(f"fem: patch_width {rule}, got {width:g}")
        eccentricity = scene.load.eccentricity
        if eccentricity:
            half = math.dist(*scene.block.edge(scene.block.top)) / 2
            if abs(eccentricity) >= half:
                raise ValueError(f"load: eccentricity must be below half the top edge {half:g}, got {eccentricity:g}")
        if scene.contact.rule not in ("newmark", "augmented"):
            _check_rule(scene.contact.rule, scene.time)


def _check_rule(contact_rule: str, t: Any) -> None:
    """Check the scheme of a rule that steps the block by its own one."""
    rule = f"rule = {contact_rule!r}"
    if t.scheme != "newmark":
        raise ValueError(f'contact: {rule} goes with time.scheme = "newmark", got "{t.scheme}"')
    numbers = f"got {t.alpha:g} and {t.delta:g}"
    if contact_rule == "impact":
        # Moreau and Jean's theta is this family of Newmark's; 1e-12 is for numbers of few digits.
        theta = (t.delta + 0.5) / 2
        if not (0.5 <= theta <= 1 and math.isclose(t.alpha, theta**2, rel_tol=1e-12)):
            raise ValueError(
                f"contact: {rule} steps by Moreau's theta: time.alpha must be theta^2 and time.delta "
                f"2 theta - 1/2 with theta from 1/2 to 1, such as 0.25 and 0.5, {numbers}"
            )
    elif (t.alpha, t.delta) != (0.25, 0.5):
        raise ValueError(
            f"contact: {rule} steps the block by average acceleration: time.alpha must be 0.25 and time.delta "
            f"0.5, {numbers}"
        )


KIND = Block
