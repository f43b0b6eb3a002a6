"""Discontinuous deformation analysis of the two-block model.

One elastic polygonal block on locked contact springs, pressed from above, stepped by Newmark's
scheme with kinetic damping, in a form that keeps its digits for stiff springs; the printed
recursion beside it; the scheme's spectral formulas. Importing the package costs numpy only.
"""

from dda import spectral
from dda.block import Block
from dda.contact import Contact, contact_stiffness, spring_vectors
from dda.gap_form import COLUMNS, UNKNOWNS, GapForm
from dda.load import BaseMotion, Load
from dda.material import Material
from dda.modes import Diagnostics, Mode, diagnostics, modes, one_step_operator
from dda.natural_modes import ModalForm, modal_form
from dda.newmark import Scheme
from dda.polygon import Section
from dda.solution import Result, solve
from dda.textbook import solve_textbook, textbook_applicable
from dda.two_block import TwoBlockModel

__all__ = [
    "COLUMNS",
    "UNKNOWNS",
    "BaseMotion",
    "Block",
    "Contact",
    "Diagnostics",
    "GapForm",
    "Load",
    "Material",
    "ModalForm",
    "Mode",
    "Result",
    "Scheme",
    "Section",
    "TwoBlockModel",
    "contact_stiffness",
    "diagnostics",
    "modal_form",
    "modes",
    "one_step_operator",
    "solve",
    "solve_textbook",
    "spectral",
    "spring_vectors",
    "textbook_applicable",
]
