"""The damping that a scene really has, what to choose instead, and alarms.

Closed forms of the scheme and finished rows come in; nothing that runs a study.
"""
