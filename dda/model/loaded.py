"""A block over contacts, with loads on its top edge and on its mass: what the models of one block share."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from dda.model.block import Block
from dda.model.load import Load, pressed_part


@dataclass(frozen=True, eq=False, init=False)
class LoadedBlock:
    """One block over the contacts of its base edge. Edge i runs from corner i to corner i + 1.

    Raises
    ------
    ValueError
        If a number is not finite, the eccentricity leaves nothing of the top edge, or base and top are not two edges
        of the block.
    """

    block: Block
    contact: Any
    load: Load
    base: int  # edge over the corners M (its start) and N (its end)
    top: int  # edge under pressure and traction

    def __init__(
        self, block: Block, contact: Any, load: Load | float = 0.0, base: int = 0, top: int = 2, **others: Any
    ) -> None:
        """Set the fields and check them.

        Parameters
        ----------
        load
            All loads, or a pressure alone [Pa].
        others
            Further fields of the model, and fields of `Load` in place of those in `load`, by name.
        """
        loads = load if isinstance(load, Load) else Load(pressure=load)
        changes = {name: others.pop(name) for name in set(Load.__dataclass_fields__) & set(others)}
        values = {"block": block, "contact": contact, "load": dataclasses.replace(loads, **changes), "base": base}
        values |= {"top": top} | others
        for name in set(values) - {field.name for field in dataclasses.fields(self)}:
            raise TypeError(f"{name}: is no field of {type(self).__name__} or Load")
        for name, value in values.items():
            object.__setattr__(self, name, value)
        self.check()

    def check(self) -> None:
        """Check the loads and the edges."""
        self.block.check_edges(self.base, self.top)
        pressed_part(*self.block.edge(self.top), self.load.eccentricity)

    def __getattr__(self, name: str) -> Any:
        """Return a field of the loads, which is read as one of the model too."""
        if name in Load.__dataclass_fields__:
            return getattr(self.load, name)
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    @property
    def base_length(self) -> float:
        """Length a of the base edge [m]."""
        start, end = self.block.edge(self.base)
        return float(np.hypot(*(end - start)))
