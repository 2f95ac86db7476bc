"""The command by ``python -m qbound``."""

import sys

from qbound.cli import main

if __name__ == "__main__":
    sys.exit(main())
