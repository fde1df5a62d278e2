"""Run the command as ``python -m palms``."""

import sys

try:
    from palms.cli import main
except KeyboardInterrupt:  # as when it comes later
    sys.exit(130)

if __name__ == "__main__":
    main()
