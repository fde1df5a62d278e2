"""Run the command as ``python -m palms``."""

from palms.cli import main

if __name__ == "__main__":
    main()
