"""Another program's history, judged against a scene: reading, fitting, naming causes, and saying so in sentences."""

from validation.diagnosis.judgement import compare as compare
