"""Text from outside (errors, names, titles) in characters that every file and terminal takes."""

from __future__ import annotations


def printable(text: str) -> str:
    """Return a text whose control characters and lone surrogates are written as escapes, line breaks as blanks."""
    return shown(" ".join(text.split()))


def shown(text: str) -> str:
    """Return a text whose control characters and lone surrogates are written as escapes."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c == "\u00a0" else c.encode("unicode_escape").decode() for c in text)


def visible(text: str) -> str:
    """Return lines of text whose control characters, overrides of direction and lone surrogates are escapes.

    What reaches a terminal or a page passes here: a scene, a submission, a solver or an old row may have brought it.
    """
    return "".join(c if c in "\n\t" else shown(c) for c in text)


def error_text(error: BaseException) -> str:
    """Return an error in one line: its type and its text."""
    return printable(f"{type(error).__name__}: {error}").removesuffix(":")
