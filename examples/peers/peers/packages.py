"""Programs that are Python packages or commands: looked up where they are needed, and named where they are absent."""

import importlib
import importlib.metadata
import shutil


def imported(module, title, recipe):
    """Return the module of a program.

    Raises
    ------
    NotImplementedError
        It is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise NotImplementedError(f"{title} is not installed: {recipe}") from error


def command_of(name, title, recipe):
    """Return the path of a program's command.

    Raises
    ------
    NotImplementedError
        It is not installed.
    """
    found = shutil.which(name)
    if found is None:
        raise NotImplementedError(f"{title} is not installed: {recipe}")
    return found


def version_of(package):
    """Return the version of a package, or that it is not installed."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"
