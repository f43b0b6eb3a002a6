"""The judgement of a history, which is in `validation.diagnosis`."""

from validation.diagnosis.answer import Answer as Answer
from validation.diagnosis.judgement import compare as compare
