"""Discontinuous deformation analysis of the two-block model, of systems of glued blocks, and of blocks in the plane.

One elastic polygonal block on locked contact springs, pressed from above, stepped by Newmark's
scheme with kinetic damping, in a form that keeps its digits for stiff springs; the printed
recursion beside it; the scheme's spectral formulas. Importing the package costs numpy only.
"""

from dda.contact.springs import Contact, contact_stiffness, spring_vectors
from dda.contact.unilateral import Unilateral
from dda.model.block import Block
from dda.model.load import BaseMotion, Load
from dda.model.material import Material
from dda.model.polygon import Section
from dda.one_block.contact_result import ContactResult
from dda.one_block.gap_form import COLUMNS, UNKNOWNS, GapForm
from dda.one_block.modes import Diagnostics, Mode, diagnostics, modes
from dda.one_block.natural_modes import ModalForm, modal_form
from dda.one_block.response import response
from dda.one_block.solution import ADAPTIVE_COLUMNS, Result, solve, solve_adaptive
from dda.one_block.textbook import solve_textbook, textbook_applicable
from dda.one_block.two_block import TwoBlockModel
from dda.one_block.unilateral import UnilateralModel, UnilateralOptions, solve_unilateral
from dda.plane.first_contact import FirstContact, first_block_contact, first_contact
from dda.plane.model import ContactSprings, CornerOnEdge, EdgeBond, PlaneBlock, PlaneLoad, PlaneModel
from dda.plane.solution import PlaneContact, PlaneResult, solve_plane
from dda.scheme import roots, spectral
from dda.scheme.named import SCHEMES, named_scheme
from dda.scheme.newmark import Scheme
from dda.system.glued import GluedBlocks, Traction, glued_blocks
from dda.system.joints import FIXED, Joint, shared_edges
from dda.system.opening import OpeningSystem, opening_subdivided, solve_opening_system
from dda.system.response import system_response
from dda.system.solution import highest_frequency, solve_system, static_system, system_modes
from dda.system.subdivision import subdivided
from dda.system.system import BlockSystem, SurfaceLoad

__all__ = [
    "ADAPTIVE_COLUMNS",
    "COLUMNS",
    "FIXED",
    "SCHEMES",
    "UNKNOWNS",
    "BaseMotion",
    "Block",
    "BlockSystem",
    "Contact",
    "ContactResult",
    "ContactSprings",
    "CornerOnEdge",
    "Diagnostics",
    "EdgeBond",
    "FirstContact",
    "GapForm",
    "GluedBlocks",
    "Joint",
    "Load",
    "Material",
    "ModalForm",
    "Mode",
    "OpeningSystem",
    "PlaneBlock",
    "PlaneContact",
    "PlaneLoad",
    "PlaneModel",
    "PlaneResult",
    "Result",
    "Scheme",
    "Section",
    "SurfaceLoad",
    "Traction",
    "TwoBlockModel",
    "Unilateral",
    "UnilateralModel",
    "UnilateralOptions",
    "contact_stiffness",
    "diagnostics",
    "first_block_contact",
    "first_contact",
    "glued_blocks",
    "highest_frequency",
    "modal_form",
    "modes",
    "named_scheme",
    "opening_subdivided",
    "response",
    "roots",
    "shared_edges",
    "solve",
    "solve_adaptive",
    "solve_opening_system",
    "solve_plane",
    "solve_system",
    "solve_textbook",
    "solve_unilateral",
    "spectral",
    "spring_vectors",
    "static_system",
    "subdivided",
    "system_modes",
    "system_response",
    "textbook_applicable",
]
