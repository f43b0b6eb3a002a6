"""Blocks in the plane: polygons that move, turn and deform by one strain, and what joins and drives them."""
