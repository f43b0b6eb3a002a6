"""The catalogue of causes, which is in `validation.diagnosis`."""

from validation.diagnosis.causes import CAUSES as CAUSES
