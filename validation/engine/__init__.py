"""Cases, their keys and execution; studies run once, kept, compared and judged."""

from validation.engine.run import run_study as run_study
