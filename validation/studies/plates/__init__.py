"""A plate with a hole and a disc, of triangles that are glued."""
