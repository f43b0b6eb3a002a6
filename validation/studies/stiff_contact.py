"""The study `stiff-contact`: constant acceleration lets a stiff contact ring, (9/16, 1) does not.

Far above w dt = 4 one root of constant acceleration tends to -1, |lambda| = 1 - 8 / (w dt)^2, so that a stiff contact
changes sign every step and is hardly damped; with alpha = 9/16 = (1/2 + delta)^2 / 4 both roots tend to -1/3.
"""

from __future__ import annotations

from collections.abc import Iterator

from validation.gates.gate import Gate
from validation.studies.bands import about, cases, gate
from validation.studies.declaration import Study
from validation.theory import spectra

SCENE = "stiff-contact"


def gates() -> Iterator[Gate]:
    """Yield the gates on the contact mode's eigenvalue and on the steps to settle."""
    root = "the contact mode's root from trace and determinant: near -1 for (1/2, 1), near -1/3 for (9/16, 1)"
    whole = "first step from which the value stays within 1e-4 of static: a whole number, the same in sixty digits"
    for case in cases(SCENE):
        radius = spectra.spectral_radius(case, spectra.contact_frequency(case))
        half = 1e-11  # rounding of a root near -1, whose distance from it may be 1e-8
        yield gate(case, "dda", "contact.spectral_radius", about(radius, half), root)
        for quantity in ("displacement", "pressure"):
            yield gate(case, ("dda", "dda-60"), f"{quantity}.fine_settling_step", (0.0, 0.0), whole)


STUDY = Study(
    name="stiff-contact",
    title="A stiff contact rings under constant acceleration",
    purpose="How many steps do displacement and contact pressure take to settle as the contact springs get stiffer, "
    "under constant acceleration (1/2, 1) and under (9/16, 1)?",
    scenes=(SCENE,),
    gates=lambda: tuple(gates()),
    pairs=(("dda", "dda-60"), ("dda", "bar")),
)
