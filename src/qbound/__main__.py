"""The command, and ``python -m qbound``: what it needs is loaded where Ctrl-C is expected."""

import sys


def start() -> int:
    """Run the command that was typed; 130 if it is stopped, even before it has been loaded."""
    try:
        from qbound.cli import main

        return main()
    except KeyboardInterrupt:
        print("qbound: stopped", file=sys.stderr)  # noqa: T201
        return 130


if __name__ == "__main__":
    sys.exit(start())
