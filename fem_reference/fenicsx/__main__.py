"""Load this folder as a package of a name of its own, so that nothing else of its parent is reached, and run it."""

import importlib.util
import sys
from pathlib import Path

NAME = "dda_validation_fenicsx"


def load() -> None:
    """Make this folder the package `NAME`."""
    folder = Path(__file__).parent
    spec = importlib.util.spec_from_file_location(
        NAME, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    if spec is None or spec.loader is None:
        raise ImportError(f"{folder}: is not a package")
    package = importlib.util.module_from_spec(spec)
    sys.modules[NAME] = package
    spec.loader.exec_module(package)


if __name__ == "__main__":
    load()
    importlib.import_module(f"{NAME}.loop").main()
