"""Numbers as people read them: rounded for records, in plain text for messages and terminals, set for pages.

Inside a sentence of plain text a format code (``{step:.4g} s``) says all there is to say. Whatever needs a decision is
decided here: rounding, no value, the sign of zero, per cent, powers of ten, units, the characters of a page.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence

ROUNDING = 1e-12  # a number of this size or less is rounding, and differs from processor to processor
DASH = "–"
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def significant(value: float, digits: int) -> float:
    """Return a number rounded to significant digits."""
    return float(f"{value:.{digits}g}")


def measured_text(value: object) -> str:
    """Return a measured number as text, ``below 1e-12`` where it is rounding; a count, which is an integer, in full."""
    if isinstance(value, float) and abs(value) <= ROUNDING:
        return f"below {ROUNDING:g}"
    return f"{value:.4g}" if isinstance(value, float | int) else str(value if value is not None else "-")


def band_text(band: Sequence[float] | None) -> str:
    """Return the edges of a band as text, a dash where there is none."""
    return "-" if band is None else " .. ".join(f"{edge:.4g}" for edge in band)


def number_text(value: float | str | None, digits: int = 4, factor: float = 1.0, unit: str = "") -> str:
    """Return a number in a unit, a dash where there is none; what is rounding is zero, and zero has no sign."""
    if value is None or isinstance(value, str):
        return "-"
    scaled = factor * value
    return f"{0.0 if abs(scaled) < 1e-9 else scaled:.{digits}g}{unit}"


def share_text(value: float, digits: int = 3) -> str:
    """Return a fraction in per cent."""
    return f"{100 * value:.{digits}g} %"


def remainder_text(value: float, digits: int = 3) -> str:
    """Return what is left, a fraction, in per cent without its unit; rounding is not written as digits."""
    return f"{100 * value:.{digits}g}" if abs(value) > ROUNDING else f"below {100 * ROUNDING:g}"


def stated_text(value: object) -> str:
    """Return a datum as it is stated, each number of a list by itself."""
    if isinstance(value, tuple):
        return ", ".join(map(stated_text, value)) or "none"
    return f"{value:g}" if isinstance(value, float) else str(value)


def raised(number: int) -> str:
    """Return a whole number in superscript digits."""
    return str(number).translate(_RAISED)


def power(value: float, digits: int = 2) -> str:
    """Return a number as mantissa times a power of ten, ``3.6×10⁻²``."""
    if value == 0 or not math.isfinite(value):
        return plain(value, digits)
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa}×10{raised(int(exponent))}".replace("-", "−")


def plain(value: float, digits: int = 4) -> str:
    """Return a number with significant digits, as a power of ten outside 1e-3 to 1e6."""
    if math.isnan(value):
        return "not a number"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if value and not 1e-3 <= abs(value) < 1e6:
        return power(value, digits)
    text = f"{value:#.{digits}g}" if value else "0"
    return (f"{value:.0f}" if "e" in text else text.removesuffix(".")).replace("-", "−")


def short(value: float, digits: int = 4) -> str:
    """Return a number as `plain` does, without zeros at the end of its decimals."""
    return re.sub(r"(\.\d*?)0+(?=×|$)", r"\1", plain(value, digits)).replace(".×", "×").removesuffix(".")


def decimal(value: float, decimals: int) -> str:
    """Return a number with this many decimals; zero has no sign."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")


def bounded(value: float, text: str) -> str:
    """Return the text of a measured value; where it is rounding, say that it is below 1e-12."""
    return f"<10{raised(-12)}" if isinstance(value, float) and abs(value) <= ROUNDING else text


def percent(value: float) -> str:
    """Return a fraction in per cent, or as a power of ten below 0.01 %."""
    return f"{short(100 * value, 3)}\u00a0%" if value == 0 or value >= 1e-4 else power(value)


def signed_percent(value: float) -> str:
    """Return a fraction in per cent with its sign, also where it is positive."""
    return f"{'+' if value >= 0 else '−'}{percent(abs(value))}"


def error_percent(value: float | None) -> str:
    """Return an error, a fraction, in per cent; rounding is not written as digits."""
    if value is None:
        return DASH
    return "below 1e-9 %" if value < 1e-11 else f"{short(100 * value, 2)} %"


def milliseconds(seconds: float) -> str:
    """Return a time in milliseconds, ``2 ms``."""
    return f"{1e3 * seconds:.3g}\u00a0ms"


def tick_text(value: float) -> str:
    """Return the number at a tick, as a power of ten, or some of it, where it is long."""
    return f"{value:g}" if 1e-3 < value < 1e4 else _decade(value)


def _decade(value: float) -> str:
    share, _, exponent = f"{value:.0e}".partition("e")
    mantissa = "" if share == "1" else share + r"{\times}"  # in braces, without the spaces of an operator
    return f"${mantissa}10^{{{int(exponent)}}}$"


def _brief(value: float) -> str:
    """Return a number that fits into a cell of a map."""
    if abs(value) < 1e-9:
        return "0"
    if abs(value) < 1e-3:
        return "<0.001"
    return short(value, 3) if value < 100 else f"{value:.0f}"


def _signed(value: float) -> str:
    """Return a number with its sign, without a power of ten where it is large."""
    code = "+.0f" if abs(value) >= 1000 else "+.3g"
    return f"{value:{code}}".replace("-", "−")


FORMS: Mapping[str, Callable[[float, int], str]] = {  # how a number is written with some digits
    "plain": plain,
    "short": short,
    "percent": lambda value, _: f"{'−' * (value < 0)}{percent(abs(value))}",
    "power": lambda value, _: bounded(value, power(value)),
    "share": lambda value, digits: short(value, digits) if abs(value) > 1e-10 else "0",  # of what is rounding none
    "g": lambda value, _: f"{value:g}",
    "per cent": share_text,  # in plain text
    "brief": lambda value, _: _brief(value),
    "signed": lambda value, _: _signed(value),
    "decade": lambda value, _: _decade(value),  # on an axis
    "digits": lambda error, _: f"{math.floor(min(16.0, max(0.0, -math.log10(max(error, 1e-16)))))}",  # that are right
    "three": lambda value, _: f"{value:.3g}",
    "measured": lambda value, digits: bounded(value, short(value, digits)),
    "grouped": lambda value, _: f"{value:,.0f}".replace(",", "\u00a0"),  # by thousands
    "signed percent": lambda value, _: signed_percent(value),
    "ms": lambda seconds, _: milliseconds(seconds),
    "ratio": lambda value, _: f"{value:g}E",  # p over Young's modulus
}
