"""Discontinuous deformation analysis of the two-block model, and of systems of glued blocks.

One elastic polygonal block on locked contact springs, pressed from above, stepped by Newmark's
scheme with kinetic damping, in a form that keeps its digits for stiff springs; the printed
recursion beside it; the scheme's spectral formulas. Importing the package costs numpy only.
"""

from dda import spectral
from dda.block import Block
from dda.contact import Contact, contact_stiffness, spring_vectors
from dda.gap_form import COLUMNS, UNKNOWNS, GapForm
from dda.joints import FIXED, Joint, shared_edges
from dda.load import BaseMotion, Load
from dda.material import Material
from dda.modes import Diagnostics, Mode, diagnostics, modes, one_step_operator
from dda.natural_modes import ModalForm, modal_form
from dda.newmark import Scheme
from dda.polygon import Section
from dda.solution import Result, solve
from dda.subdivision import subdivided
from dda.system import BlockSystem, SurfaceLoad
from dda.system_solution import highest_frequency, solve_system, static_system, system_modes
from dda.textbook import solve_textbook, textbook_applicable
from dda.two_block import TwoBlockModel

__all__ = [
    "COLUMNS",
    "FIXED",
    "UNKNOWNS",
    "BaseMotion",
    "Block",
    "BlockSystem",
    "Contact",
    "Diagnostics",
    "GapForm",
    "Joint",
    "Load",
    "Material",
    "ModalForm",
    "Mode",
    "Result",
    "Scheme",
    "Section",
    "SurfaceLoad",
    "TwoBlockModel",
    "contact_stiffness",
    "diagnostics",
    "highest_frequency",
    "modal_form",
    "modes",
    "one_step_operator",
    "shared_edges",
    "solve",
    "solve_system",
    "solve_textbook",
    "spectral",
    "spring_vectors",
    "static_system",
    "subdivided",
    "system_modes",
    "textbook_applicable",
]
