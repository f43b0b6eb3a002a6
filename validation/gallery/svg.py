"""A figure as part of a page: the same drawing in fewer bytes, letters drawn once for all figures of the page."""

from __future__ import annotations

import re
from html import escape

_UNSEEN = re.compile(r"<!--.*?-->|<metadata>.*?</metadata>|<!DOCTYPE.*?>|<\?xml.*?\?>", re.S)
_NUMBER = re.compile(r"(?<![\w.#])-?\d+\.\d{2,}(?:e-?\d+)?")
_GROUP = re.compile(r'<g id="[^"]*">')
_PATH = re.compile(r' d="([^"]*)"')
_COMMAND = re.compile(r"([A-Za-z])([^A-Za-z]*)")
_STYLE = re.compile(r' style="[^"]*"')
_ALONE = re.compile(r"<g>(<(?:use|path)\b[^>]*/>)</g>")
_LETTER = re.compile(r'<path id="(DejaVu[^"]*)"[^>]*/>')
_USED_LETTER = re.compile(  # placed by a transform, or by x and y as older versions of matplotlib do
    r'<use xlink:href="#(DejaVu[^"]*)"(?: transform="translate\((\S+) (\S+)\)( scale[^"]*)?"|((?: [xy]="[^"]*")*))/>'
)
_NAME = re.compile(r'(id="|href="#|url\(#)([^")]+)')
_ROOT = re.compile(r"<svg\b[^>]*?viewBox=\"([^\"]*)\"[^>]*>")
REPEATED = "LQC"  # commands that go on without their letter
NESTED = 3  # groups around one element


def slim(svg: str) -> str:
    """Return a drawing with coordinates to a hundredth of a point, without what is not seen."""
    text = _GROUP.sub("<g>", _UNSEEN.sub("", svg))
    text = _NUMBER.sub(lambda match: _rounded(float(match[0])), text)
    text = re.sub(r"\s*\n\s*", " ", text).replace("> <", "><").strip()
    text = _STYLE.sub(lambda match: match[0].replace(": ", ":").replace("; ", ";"), text)
    for _ in range(NESTED):
        text = _ALONE.sub(r"\1", text)
    return _PATH.sub(lambda match: f' d="{_path(match[1])}"', text)


def _rounded(value: float) -> str:
    """Return a coordinate to a hundredth, or a scale below one to four digits."""
    return f"{value:.2f}".rstrip("0").rstrip(".") if abs(value) >= 1 else f"{value:.4g}"


def _path(data: str) -> str:
    """Return the commands of a path without needless letters and blanks."""
    parts = []
    last = ""
    for command, numbers in _COMMAND.findall(data):
        letter = " " if command == last and command in REPEATED else command
        parts.append(letter + " ".join(numbers.split()))
        last = command
    return "".join(parts)


class Sheet:
    """The figures of one page."""

    def __init__(self) -> None:
        self._letters: dict[str, str] = {}  # name in the figures, name on the page
        self._count = 0

    def placed(self, svg: str, caption: str) -> str:
        """Return a figure for this page: names of its own, a caption for those who do not see it."""
        self._count += 1
        text = _NAME.sub(self._unique_name, slim(svg))
        text = _USED_LETTER.sub(self._placed_letter, _LETTER.sub(self._letter_once, text)).replace("<defs></defs>", "")
        label = escape(" ".join(caption.split()), quote=True)
        return _ROOT.sub(
            lambda match: (
                f'<svg xmlns:xlink="http://www.w3.org/1999/xlink" xmlns="http://www.w3.org/2000/svg" '
                f'viewBox="{match[1]}" role="img" aria-label="{label}">'
            ),
            text,
            count=1,
        )

    def _unique_name(self, match: re.Match[str]) -> str:
        """Return a name that no other figure of the page has; letters keep theirs, which are the same everywhere."""
        return match[0] if match[2].startswith("DejaVu") else f"{match[1]}f{self._count}-{match[2]}"

    def _letter_once(self, match: re.Match[str]) -> str:
        """Return the drawing of a letter where it is the first of the page."""
        if match[1] in self._letters:
            return ""
        self._letters[match[1]] = f"l{len(self._letters)}"
        return match[0].replace(match[1], self._letters[match[1]])

    def _placed_letter(self, match: re.Match[str]) -> str:
        """Return a letter at its place, which is stated in units of a hundredth of its size and less."""
        name, x, y, scale, attributes = match.groups()
        if attributes:
            return f'<use href="#{self._letters[name]}"{attributes}/>'
        if scale:
            return f'<use href="#{self._letters[name]}" transform="translate({x} {y}){scale}"/>'
        place = [f' {axis}="{float(v):.4g}"' for axis, v in (("x", x), ("y", y)) if v and float(v)]
        return f'<use href="#{self._letters[name]}"{"".join(place)}/>'
