"""Published impacts, by exact motions, by DDA and by elements."""
