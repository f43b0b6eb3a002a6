"""A Dask cluster's workers in place of this machine's cores; the only import of the optional `distributed`."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from validation.errors import InputError

PATIENCE = "10s"  # for the scheduler to answer


@contextmanager
def executor(address: str | None) -> Iterator[Executor | None]:
    """Yield the executor of the cluster at an address such as ``tcp://host:8786``; None for the machine's own cores.

    A case whose worker is lost runs again on another one; the finished ones are in the results directory already.

    Raises
    ------
    InputError
        The package `distributed` is not installed, or nobody answers at the address.
    """
    if address is None:
        yield None
        return
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            "needs the package distributed", field="--scheduler", advice="pip install 'dda-validation[cluster]'"
        ) from None
    try:
        client = Client(address, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise InputError(
            "must be the address of a running Dask scheduler", field="--scheduler", value=f"{address!r}: {error}"
        ) from None
    with client:
        yield client.get_executor(pure=False)
