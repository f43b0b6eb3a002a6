"""A warning fails a test where this project's own code is blamed for it, and not where dependencies quarrel."""

import warnings
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = sorted(path.parent.name for path in ROOT.glob("*/__init__.py"))
OWN_TESTS = ["tests.house.test_warnings", "test_warnings", "conftest", "faults.fault", "oracles.elements"]


def warn(module, kind):
    """Warn as Python does on behalf of a module."""
    warnings.warn_explicit("old name", kind, f"{module}.py", 1, module=module)


@pytest.mark.parametrize("kind", [DeprecationWarning, RuntimeWarning, UserWarning])
def test_a_warning_of_our_own_is_an_error(kind):
    for module in (*PACKAGES, *(f"{name}.some.module" for name in PACKAGES), "tests.x", *OWN_TESTS):
        with pytest.raises(kind, match="old"):
            warn(module, kind)
