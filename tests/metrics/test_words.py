"""What a person reads in place of a metric's id, and of a value that it has not."""

from validation.metrics.catalogue import ALL, is_count, words_of


def test_each_metric_has_words_of_its_own_without_the_dots_of_an_id():
    words = [metric.words for metric in ALL.values()]
    assert len(set(words)) == len(ALL) > 80
    assert not [text for text in words if "." in text.replace("0.01 %", "") or "_" in text]
    assert words_of("mode1.damping") == ALL["mode1.damping"].words
    assert words_of("wave.left") == "wave.left"  # of a study, which is in no catalogue


def test_what_counts_steps_or_switches_has_a_zero_that_is_none():
    names = ("switches.count", "pressure.settling_step", "displacement.l2", "wave.left")
    assert [is_count(name) for name in names] == [True, True, False, False]
