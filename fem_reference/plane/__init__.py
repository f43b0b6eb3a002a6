"""A plane elastic body of any polygonal outline, clamped or free, beside blocks that are glued together."""
