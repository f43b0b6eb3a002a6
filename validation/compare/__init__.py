"""Another program's history, judged against a scene: the names under which `validation.diagnosis` is known."""

from validation.diagnosis import compare as compare
