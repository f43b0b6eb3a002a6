"""Records that hold arrays are compared by identity: equality of arrays is no truth value."""

import importlib
import importlib.util
import pkgutil
from dataclasses import fields, is_dataclass

import dda

NEED_NUMBA = ["dda.march.pointers"]
NAMES = [module.name for module in pkgutil.walk_packages(dda.__path__, "dda.")]
MODULES = [
    importlib.import_module(name) for name in NAMES if name not in NEED_NUMBA or importlib.util.find_spec("numba")
]
RECORDS = {
    record.__name__: record
    for module in MODULES
    for record in vars(module).values()
    if isinstance(record, type) and is_dataclass(record) and record.__module__ == module.__name__
}


def test_what_holds_arrays_is_compared_by_identity():
    for name, record in RECORDS.items():
        if any("Array" in str(field.type) or "Block" in str(field.type) for field in fields(record)):
            assert record.__eq__ is object.__eq__, name
