"""The command ``dda-validate``; nothing of the package `validation` is imported before it is known to be ours."""

import signal
import sys

from .siblings import shadowed


def main() -> None:
    """Run the command line on one BLAS thread; an interruption before it is ready ends without a traceback."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    if sentence := shadowed():
        sys.stderr.write(f"error: {sentence}\n")
        raise SystemExit(2)
    from validation.runs.threads import limit_process

    limit_process()
    from validation.cli import main as run

    run()
