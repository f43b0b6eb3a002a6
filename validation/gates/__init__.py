"""Bands for metrics, their verdicts, changes of verdicts between two runs.

Nothing that runs or measures comes in.
"""

from validation.gates.gate import Gate as Gate
from validation.gates.gate import Status as Status
from validation.gates.gate import Verdict as Verdict
