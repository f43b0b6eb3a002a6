"""A column as plain data."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, ClassVar

from validation.errors import InputError
from validation.models.column.tables import ColumnSection, Contact, InputSection, JointSection, LayerSection
from validation.runs.units import named
from validation.scenes.keys import keys_of, stated_value
from validation.scenes.plain import PlainHooks, plain
from validation.scenes.scene import Scene

OF_COLUMN = ("motion", "law", "gravity", "settled", "base", "base_density", "base_speed", "heights")


class HOOKS(PlainHooks):
    """Layers, joints or contacts, and the input."""

    tables: ClassVar = {"column.layers": LayerSection, "column.joints": JointSection, "input": InputSection}
    unstated: ClassVar = {
        LayerSection: frozenset({"blocks"}),
        JointSection: frozenset({"gap", "strength", "friction"}),
        InputSection: frozenset({"record"}),
    }

    def data(self, scene: Scene) -> dict[str, Any]:
        """Return column and input."""
        column = scene.table(ColumnSection)
        drive = scene.stated_input
        if drive is not None and drive.shape is None:
            raise InputError(
                "must be a shape in a problem, whose data hold no record",
                source=scene.name,
                field="input.shape",
                value="a record",
            )
        data = {}
        for name, _, key in keys_of(ColumnSection):
            if name in OF_COLUMN:
                data[named(name, key.unit)] = plain(stated_value(column, name))
        if column.base == "springs":  # the lowest of the joints or contacts
            data["base"] = "rigid"
        data["layers"] = [self.table(layer) for layer in column.layer]
        if column.law == "bonded":
            data["glue_Pa_per_m"] = column.glue
            data["joints"] = [self.table(spring) for spring in column.springs]
        else:
            data["contacts"] = [_contact_data(contact) for contact in column.contacts]
        return {"column": data, "input": None if drive is None else self.table(drive)}


def _contact_data(contact: Contact) -> dict[str, Any]:
    """Return a contact of a column; friction is the strength that it amounts to."""
    units = {name: key.unit for name, _, key in keys_of(JointSection)}
    return {named(field.name, units[field.name]): plain(getattr(contact, field.name)) for field in fields(contact)}
