"""Boxes on a ground by dda, against their exact motions."""
