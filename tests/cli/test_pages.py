"""What commands print, kept word by word: the one place for wordings. Numbers may differ where no digit is meant.

The numbers are computed apart beside the functions that they come from; here a page is only held to what it was. A page
that is changed on purpose is written anew by ``python tests/cli/test_pages.py``.
"""

import json
import re
import shlex
import sys
from itertools import groupby
from pathlib import Path

import pytest

PAGES = Path(__file__).with_name("pages.json")
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
KEPT = json.loads(PAGES.read_text(encoding="utf-8"))  # command line -> status and lines of output and error
COMMANDS = {name: list(lines) for name, lines in groupby(sorted(KEPT), key=lambda line: line.split()[0])}


def page(line: str) -> list[object]:
    """Return status, and lines of output and error, of a command line."""
    from conftest import typed

    done = typed(*shlex.split(line), cwd=PAGES.parent)
    return [done.returncode, *(done.stdout + done.stderr).splitlines()]


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_prints_what_it_did(command: str) -> None:
    for line in COMMANDS[command]:
        printed, kept = ("\n".join(map(str, lines)) for lines in (page(line), KEPT[line]))
        assert NUMBER.sub("#", printed) == NUMBER.sub("#", kept), line
        numbers = [[float(text) for text in NUMBER.findall(lines)] for lines in (printed, kept)]
        assert numbers[0] == pytest.approx(numbers[1], rel=2e-3, abs=1e-9), line


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))
    PAGES.write_text(json.dumps({line: page(line) for line in KEPT}, indent=1) + "\n", encoding="utf-8")
