"""A column of blocks as a wave guide: the tables `[column]` and `[input]`."""
