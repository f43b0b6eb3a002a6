"""What is measured on histories and modes; nothing here runs a solver."""

from validation.metrics.values import ratio as ratio
