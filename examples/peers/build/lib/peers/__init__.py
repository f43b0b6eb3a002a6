"""Adapters of other people's programs, one file each; `docs/extending.md` is their contract."""
