"""What a person reads in place of a metric's id, and of a value that it has not."""

from validation.metrics.catalogue import ALL, in_words, is_count, words_of
from validation.metrics.values import UNDEFINED


def test_each_metric_has_words_of_its_own_without_the_dots_of_an_id():
    words = [metric.words for metric in ALL.values()]
    assert len(set(words)) == len(ALL) > 80
    assert not [text for text in words if "." in text.replace("0.01 %", "") or "_" in text]
    assert words_of("mode1.damping") == ALL["mode1.damping"].words
    assert words_of("wave.left") == "wave.left"  # of a study, which is in no catalogue


def test_an_undefined_value_says_why_and_others_stay_what_they_are():
    assert in_words("pressure.fine_settling_step", UNDEFINED) not in (UNDEFINED, "", None)
    assert in_words("displacement.static", UNDEFINED) == UNDEFINED  # of which nothing more is known
    assert in_words("wave.left", UNDEFINED) == UNDEFINED
    assert in_words("pressure.settling_step", 7.0) == 7.0 and in_words("pressure.settling_step", None) is None


def test_what_counts_steps_or_switches_has_a_zero_that_is_none():
    names = ("switches.count", "pressure.settling_step", "displacement.l2", "wave.left")
    assert [is_count(name) for name in names] == [True, True, False, False]
