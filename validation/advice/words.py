"""The sentences of advice: one table, `words.toml`, in which a sentence names the numbers that stand in it."""

from __future__ import annotations

from validation.runs.texts import Texts

say = Texts(__file__).text
