"""Cases, their keys and execution; studies run once, kept, compared and judged.

No particular study, solver or scene comes in.
"""

from validation.engine.run import run_study as run_study
