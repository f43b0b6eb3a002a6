"""Records that hold arrays are compared by identity: equality of arrays is no truth value."""

import importlib
import pkgutil
from dataclasses import fields, is_dataclass

import dda

NAMES = [module.name for module in pkgutil.walk_packages(dda.__path__, "dda.")]


def test_what_holds_arrays_is_compared_by_identity():
    for module in [importlib.import_module(name) for name in NAMES if name != "dda.march.pointers"]:  # without numba
        for name, record in vars(module).items():
            types = [str(field.type) for field in fields(record)] if is_dataclass(record) else []
            if any("Array" in kind or "Block" in kind for kind in types):
                assert record.__eq__ is object.__eq__, name
