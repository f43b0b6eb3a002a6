"""A search among few candidate changes."""

from validation.diagnosis import search
from validation.diagnosis.moves import Move

AVERAGE = {"alpha": 0.25, "delta": 0.5}
FEW = [  # candidates
    Move("scheme", AVERAGE),
    Move("scheme", {"start": "consistent", **AVERAGE}),
    Move("gg", {}, ("gg",), (0.97,)),
    Move("density-factor", {}, ("density",), (0.7,)),
    Move("springs-factor", {}, ("softness",), (-0.3, 0.3)),
    Move("viscous-damping", {}, ("viscous",), (3.0,)),
    Move("stiffness-damping", {}, ("structural",), (1e-4,)),
    Move("own-weight", {}, ("weight",), (0.5,)),
    Move("geometry-updated", {"point": 1.0}),  # which costs no loop over the steps
]


def among(patch, moves):
    """Let these changes alone be tried."""
    patch.setattr(search, "moves", lambda *given: moves)
    patch.setattr(search, "dead_bands", lambda *given: iter(()))
    patch.setattr(search, "BASES", search.BASES[:1])


def only(patch, *ids):
    """Let causes of these ids alone be tried."""
    every = search.moves
    patch.setattr(search, "moves", lambda *given: [move for move in every(*given) if move.id in ids])
    patch.setattr(search, "dead_bands", lambda *given: iter(()))
