"""``python -m validation`` is ``dda-validate``."""

import signal

if __name__ == "__main__":
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # until `main` takes it: no traceback from the imports
    from validation.cli import main

    main()
