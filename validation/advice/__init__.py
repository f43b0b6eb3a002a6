"""What damping a scene really runs, what to choose instead, and alarms.

Closed forms of the scheme and finished rows come in; nothing that runs a study.
"""
