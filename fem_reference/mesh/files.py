"""Files of meshes and fields: the one module that meets meshio, which is optional."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from typing import Any

from skfem import Mesh


def library() -> Any:
    """Return meshio, or raise a `ValueError` where it is not installed."""
    try:
        import meshio
    except ModuleNotFoundError as error:
        if error.name != "meshio":
            raise
        raise ValueError("mesh: a file of a mesh or of fields needs meshio, which is not installed") from None
    return meshio


def read_data(path: str) -> Any:
    """The points and cells of a file as meshio has them; a `ValueError` if none of its readers takes it."""
    meshio = library()
    with _refusing(path):
        return meshio.read(path)


def read_mesh(path: str) -> Mesh:
    """The plane mesh of a file; a `ValueError` if it cannot be read."""
    data = read_data(path)
    from skfem.io.meshio import from_meshio

    with _refusing(path):
        data.points = data.points[:, :2]
        return from_meshio(data)


@contextmanager
def _refusing(path: str) -> Iterator[None]:
    """Name the file in what meshio and scikit-fem say of one that they do not take."""
    messages = io.StringIO()  # meshio prints and exits where no reader of it takes the file
    try:
        with redirect_stdout(messages), redirect_stderr(messages):
            yield
    except (Exception, SystemExit) as error:  # its readers raise anything at a file that is not whole
        words = " ".join(messages.getvalue().split()) or f"{type(error).__name__}: {error}"
        raise ValueError(f"mesh: must be a readable mesh of triangles or quadrilaterals, {path!r}: {words}") from error
