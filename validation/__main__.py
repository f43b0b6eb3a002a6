"""``python -m validation`` is ``dda-validate``."""

from validation.entry.command import main

if __name__ == "__main__":
    main()
