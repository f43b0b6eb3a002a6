"""Who names whom: concrete solvers in the rooms that should not know them, private functions in tests."""

import ast
import re
from pathlib import Path

from validation.solvers.registry import BUILT_IN

ROOT = Path(__file__).parents[2]
# rooms that declare, draw and tell named solvers
KNOWING = ("solvers/", "models/", "studies/", "suite/", "report/", "cli/")
# What the other modules name today; it may only become less.
NAMED = {
    "entry/siblings.py": {"dda"},  # the package
    "scenes/tables.py": {"dda", "fem", "bar"},  # what a scene runs where it does not say
    "runs/units.py": {"bar"},  # the unit
    "advice/columns.py": {"dda"},  # whose run shows when a stack rests
    "engine/case.py": {"fem"},  # the section of a scene
    "advice/spectra.py": {"dda", "fem", "bar"},
    "advice/advice.py": {"dda", "fem", "continuum"},
    "diagnosis/other_solvers.py": {"dda", "fem", "bar", "continuum"},
}


def strings(tree):
    """Return the constants of a module that are strings."""
    return {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)}


def test_solvers_are_named_where_they_are_declared_drawn_or_told():
    quoted = re.compile("|".join(f"[\"']{re.escape(name)}[\"']" for name in BUILT_IN))
    for path in (ROOT / "validation").rglob("*.py"):
        module = path.relative_to(ROOT / "validation").as_posix()
        text = path.read_text(encoding="utf-8")
        if not module.startswith(KNOWING) and quoted.search(text):
            named = strings(ast.parse(text)) & set(BUILT_IN)
            assert named <= NAMED.get(module, set()), module


# What asks today, of a column's own numbers; it may only become less.
ASKING = {"diagnosis/judgement.py", "diagnosis/numbers.py"}
ASKS_FOR_THE_KIND = re.compile(
    r"\b(scene|case|first|base)\.((rigid|plane|column)\b|kind(\.name)? (==|!=|in|not in) )", re.M
)


def test_no_room_asks_for_the_kind_of_a_scene():
    asking = set()
    for path in (ROOT / "validation").rglob("*.py"):
        module = path.relative_to(ROOT / "validation").as_posix()
        if not module.startswith("models/") and ASKS_FOR_THE_KIND.search(path.read_text(encoding="utf-8")):
            asking.add(module)
    assert asking <= ASKING


# ---- seams ----------------------------------------------------------------------------------------------------------


# A private name that a test patches by a string.
PATCHED = re.compile(r"""setattr\([^()]*["'](?:[\w.]*\.)?_[a-z]\w*["']""")


def test_tests_patch_private_functions_by_seams_only():
    for path in (ROOT / "tests").rglob("*.py"):
        assert path == Path(__file__) or not PATCHED.search(path.read_text(encoding="utf-8")), path
    assert PATCHED.search('patch.setattr("a.b._c", 1)') and PATCHED.search("patch.setattr(module, '_d', 1)")
    assert not PATCHED.search("patch.setattr(module, module._d.__name__, 2)")
