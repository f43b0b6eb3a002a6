"""The pytest plug-in by its first name, which an editable install of an earlier version still loads."""

from validation.entry.plugin import *  # noqa: F403
