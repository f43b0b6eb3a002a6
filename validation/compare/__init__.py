"""Another program's history, judged against a scene.

Reading, fitting, naming causes, and the sentences that say so.
"""

from validation.compare.diagnosis import compare as compare
