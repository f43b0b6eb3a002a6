"""A package, so that no package of this name that a program installs stands in its place in worker processes."""
