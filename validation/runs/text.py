"""Text from outside (errors, names, titles) in characters that every file and terminal takes."""

from __future__ import annotations


def printable(text: str) -> str:
    """Return a text whose control characters and lone surrogates are written as escapes, line breaks as blanks."""
    return "".join(map(_shown, " ".join(text.split())))


def _shown(character: str) -> str:
    return character if character.isprintable() else character.encode("unicode_escape").decode()
