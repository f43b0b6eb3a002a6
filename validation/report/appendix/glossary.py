"""Twelve words that a newcomer lacks."""

from __future__ import annotations

from validation.report.blocks import Blocks, Heading, TableColumn, table

WORDS = (
    ("block", "A polygon that DDA moves as a whole: u, v, r of its centroid and one strain εx, εy, γxy all over it."),
    ("contact spring p", "The spring [N/m] that holds a corner, normal and in shear; p = 10E: p [N/m] = 10 E [Pa]."),
    ("locked, unilateral", "A locked contact also pulls; a unilateral one opens instead of pulling."),
    ("open-close iteration", "The search, within one step, for which springs act: solve, look at the gaps, repeat."),
    ("α, δ", "Weights of the new acceleration in the displacement and in the velocity of a step (Newmark's β and γ): "
     "(1/2, 1) is constant acceleration in DDA's usage; (1/4, 1/2) is average acceleration, which texts on finite "
     "elements call constant."),
    ("discount gg", "The factor on the velocity before each step: 1 changes nothing, 0 starts every step from rest."),
    ("damping ratio ξ", "Damping over critical damping: at 5 % a cycle keeps 73 % of its amplitude, at 100 % none."),
    ("|λ|, spectral radius", "What a mode keeps of its amplitude in a step; at 1 it is not damped, above 1 it grows."),
    ("bar, continuum", "The same block, exact in space at the same steps; the continuum is exact in time as well."),
    ("model form", "The error that remains however fine step and mesh are: one strain in place of a wave."),
    ("relative L2", "Root of the mean square of a difference over that of the reference, over the whole history."),
    ("gate, alarm", "A gate passes a number inside a band that has a reason; an alarm marks a result that looks "
     "better than it is."),
)  # fmt: skip


def glossary() -> Blocks:
    """Return the glossary."""
    return [Heading("Twelve words", 2), table(("Word", TableColumn("Meaning", "fill")), WORDS)]
