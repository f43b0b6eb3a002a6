"""A search among few candidate changes."""

from validation.diagnosis import search


def only(patch, *ids):
    """Let causes of these ids alone be tried."""
    every = search.moves
    patch.setattr(search, "moves", lambda *given: [move for move in every(*given) if move.id in ids])
    patch.setattr(search, "dead_bands", lambda *given: iter(()))
