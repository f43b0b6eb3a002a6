"""The declarations of the suite: scenes, solvers, gates, and what is derived from their rows.

Nothing is run or drawn here.
"""

from validation.studies.declaration import Study as Study
