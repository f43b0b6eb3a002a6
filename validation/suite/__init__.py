"""The suite: its studies, found by their folders, and what their tables say.

Nothing is run or drawn here, and no study is named.
"""

from validation.suite.declaration import Study as Study
