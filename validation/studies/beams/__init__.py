"""A study: scenes, gates and chapter."""
