"""The time schemes that have a name: a file of numbers each, listed in `catalogue`."""
