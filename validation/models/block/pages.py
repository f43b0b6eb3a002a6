"""A block in the report."""

from __future__ import annotations

from validation.report.chapters.data import CaseGroup
from validation.report.chapters.hooks import PageHooks
from validation.report.chapters.text import range_of


class HOOKS(PageHooks):
    """Springs at the corners."""

    def springs(self, group: CaseGroup) -> str:
        """Return stiffness, law and penetration, and what a step leaves of the contact mode."""
        ratios = [case.scene.contact.stiffness / case.scene.block.young for case in group.cases]
        law = group.cases[0].scene.contact.law
        text = f"p = {range_of(ratios)} E, {'carrying no tension' if law == 'unilateral' else 'locked'}"
        depths = group.numbers("dda", "contact.penetration")
        if depths:
            text += f"; at most {range_of(1e3 * depth for depth in depths)}\u00a0mm of penetration"
        left = group.numbers("dda", "contact.spectral_radius")
        if left:
            text += f". A step leaves {range_of(100 * share for share in left)}\u00a0% of the contact mode"
            if min(group.numbers("dda", "contact.least_root"), default=0.0) < 0:
                text += ", which changes sign from step to step"
        return f"{text}."
