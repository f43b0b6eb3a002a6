"""The reading of histories, which is in `validation.diagnosis`."""

from validation.diagnosis.reading import Foreign as Foreign
from validation.diagnosis.reading import parse_columns as parse_columns
from validation.diagnosis.reading import parse_scale as parse_scale
from validation.diagnosis.reading import read as read
