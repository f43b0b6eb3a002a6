"""Kinds of scenes, a folder each: its tables, what it answers to each room, found by the folder and imported by nobody.

`validation.scenes.kinds` finds them and holds what every kind says; docs/extending.md lists the hooks.
"""
