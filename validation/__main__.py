"""``python -m validation`` is ``dda-validate``."""

from validation.cli import main

if __name__ == "__main__":
    main()
