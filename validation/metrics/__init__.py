"""What is measured on histories and modes.

Functions of what a run has reported; nothing that would run a solver comes in.
"""

from validation.metrics.values import ratio as ratio
