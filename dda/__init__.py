"""Discontinuous deformation analysis of the two-block model, of systems of glued blocks, and of blocks in the plane.

One elastic polygonal block on locked contact springs, pressed from above, stepped by Newmark's scheme with kinetic
damping, in a form that keeps its digits for stiff springs; the printed recursion beside it; the scheme's spectral
formulas. Importing the package costs numpy only. Data that are out of their range, or do not go together, are a
ValueError that names field, rule and value.
"""

from dda.bodies.block_system import BlockSystem, SurfaceLoad
from dda.bodies.diagnostics import Diagnostics, diagnostics
from dda.bodies.gap_form import UNKNOWNS, GapForm, ModalForm, modal_form
from dda.bodies.glued_blocks import GluedBlocks, Traction, glued_blocks
from dda.bodies.joints import FIXED, Joint, shared_edges
from dda.bodies.locked_block import ADAPTIVE_COLUMNS, solve
from dda.bodies.locked_system import solve_system
from dda.bodies.opening_system import OpeningSystem, opening_subdivided
from dda.bodies.subdivision import subdivided
from dda.bodies.two_block import TwoBlockModel
from dda.bodies.unilateral import UnilateralModel, UnilateralOptions, solve_unilateral
from dda.contact.springs import Contact, contact_stiffness, spring_vectors
from dda.contact.unilateral import Unilateral
from dda.linear.answers import Mode, highest_frequency, modes, response, static
from dda.model.block import Block
from dda.model.load import BaseMotion, Load
from dda.model.material import Material
from dda.model.polygon import Section
from dda.plane.first_contact import FirstContact, first_contact
from dda.plane.model import ContactSprings, CornerOnEdge, EdgeBond, PlaneBlock, PlaneLoad, PlaneModel
from dda.plane.outcomes import PlaneContact
from dda.plane.solution import PlaneResult, solve_plane
from dda.result.contact_result import ContactResult
from dda.result.result import COLUMNS, Result
from dda.scheme import roots, spectral
from dda.scheme.named import SCHEMES, named_scheme
from dda.scheme.newmark import Scheme
from dda.textbook import solve_textbook, textbook_applicable

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
    "solve_plane",
    "solve_system",
    "solve_textbook",
    "solve_unilateral",
    "spectral",
    "spring_vectors",
    "static",
    "subdivided",
    "textbook_applicable",
]
