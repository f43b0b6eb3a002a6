"""Chapters of blocks with friction: those that slide (`sliding`), and stable ones that creep (`creeping`).

In come results directories and the closed forms of `gates`; no solver is called.
"""
