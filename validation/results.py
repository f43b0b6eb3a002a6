"""The results directory under the name that users import: ``from validation.results import Results``."""

from validation.runs.results import Results as Results
