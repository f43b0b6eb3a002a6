"""Studies of blocks with friction: sliding, thresholds and drag (`sliding`), creep of stable blocks (`creep`).

In come closed forms of `gates`, finished cases and what independent programs printed.
"""
