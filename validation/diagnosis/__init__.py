"""Another program's history, judged against a scene.

Reading, fitting, naming causes, and the sentences that say so.
"""

from validation.diagnosis.judgement import compare as compare
