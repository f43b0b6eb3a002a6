"""``python -m dda_validation`` is ``dda-validate``."""

from .command import main

if __name__ == "__main__":
    main()
