"""How numbers are written, in one place for messages, tables and pages."""

import functools
import math

import pytest

from validation.runs import numbers

bound = functools.partial(numbers.bounded, text="as it is")
millimetres = functools.partial(numbers.number_text, factor=1e3, unit=" mm")

NUMBERS = [  # function, value, text
    (numbers.plain, 344.561, "344.6"), (numbers.plain, -0.01, "−0.01000"), (numbers.plain, 1.2344e-7, "1.234×10⁻⁷"),
    (numbers.plain, 999999.0, "999999"), (numbers.plain, math.nan, "not a number"), (numbers.plain, -math.inf, "−∞"),
    (numbers.short, 0.25, "0.25"), (numbers.short, 5e6, "5×10⁶"), (numbers.percent, 43.7, "4370\u00a0%"),
    (numbers.percent, 2e-5, "2.0×10⁻⁵"), (numbers.percent, 0.0, "0\u00a0%"),
    (numbers.signed_percent, 0.0, "+0\u00a0%"), (numbers.signed_percent, -0.05, "−5\u00a0%"),
    (numbers.error_percent, None, "–"), (numbers.error_percent, 1e-13, "below 1e-9 %"),
    (numbers.error_percent, 0.0123, "1.2 %"), (numbers.milliseconds, 0.002, "2\u00a0ms"),
    (numbers._brief, -9e-10, "0"), (numbers._brief, -9e-4, "<0.001"), (numbers._brief, 1e-3, "0.001"),
    (numbers._brief, 99.5, "99.5"), (numbers._brief, 12.346, "12.3"), (numbers._brief, 1234.5, "1234"),
    (bound, -1e-12, "<10⁻¹²"), (bound, 0.0, "<10⁻¹²"), (bound, 0, "as it is"), (bound, 2e-12, "as it is"),
    (numbers.tick_text, 1000.0, "1000"), (numbers.tick_text, 1e5, "$10^{5}$"),
    (numbers.tick_text, 5e-5, r"$5{\times}10^{-5}$"), (numbers.measured_text, 2e-12, "2e-12"),
    (numbers.measured_text, None, "-"), (numbers.measured_text, "undefined", "undefined"),
    (numbers.measured_text, -9e-13, "below 1e-12"), (numbers.band_text, (0.5, 2 / 3), "0.5 .. 0.6667"),
    (numbers.band_text, None, "-"), (millimetres, 0.00123456, "1.235 mm"), (millimetres, -1e-14, "0 mm"),
    (millimetres, "undefined", "-"), (numbers.share_text, 0.0363249, "3.63 %"), (numbers.remainder_text, 0.5, "50"),
    (numbers.remainder_text, 1e-13, "below 1e-10"), (numbers.stated_text, (1.5, 2.0), "1.5, 2"),
    (numbers.stated_text, (), "none"), (numbers.stated_text, 7, "7"),
]  # fmt: skip


@pytest.mark.parametrize(("written", "value", "text"), NUMBERS)
def test_numbers(written, value, text):
    assert written(value) == text


def test_a_form_writes_no_minus_of_a_terminal_on_a_page():
    digits = 3
    texts = {
        name: form(-1000.0, digits) for name, form in numbers.FORMS.items() if name in ("plain", "signed", "percent")
    }
    assert texts == {"plain": "−1000", "signed": "−1000", "percent": "−100000\u00a0%"}
    assert numbers.decimal(-0.001, 2) == "0.00"
