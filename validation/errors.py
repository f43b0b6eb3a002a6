"""The error of bad input, apart from everything else, so that the command line starts without reading a scene."""

from __future__ import annotations


class InputError(ValueError):
    """A scene, an option or a file that cannot be used.

    Its text is one line, `source: field: rule, got value; advice`, of the parts that there are.

    Parameters
    ----------
    rule
        What must hold, as in "must be positive".
    source
        The file or the scene.
    field
        The key of the scene, or the option of the command.
    value
        What stands there, as it is shown.
    advice
        The next step.
    """

    def __init__(
        self,
        rule: str,
        *,
        source: object = None,
        field: str | None = None,
        value: object = None,
        advice: str | None = None,
    ) -> None:
        text = ": ".join(str(part) for part in (source, field, rule) if part is not None)
        if value is not None:
            text += f", got {value}"
        if advice is not None:
            text += f"; {advice}"
        super().__init__(text)
        self.rule = rule
        self.source = source
        self.field = field
        self.value = value
        self.advice = advice


class PlausibilityWarning(UserWarning):
    """A value of a scene that no rock, soil or concrete has, most often one in another unit."""
