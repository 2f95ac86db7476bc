"""The command, and ``python -m cspace``; imports run where Ctrl-C is handled."""

import sys


def start() -> int:
    """Run the command that was typed; return 130 if it is stopped, even while it is loading."""
    try:
        from cspace.cli import main

        return main()
    except KeyboardInterrupt:
        print("cspace: stopped", file=sys.stderr)  # noqa: T201
        return 130


if __name__ == "__main__":
    sys.exit(start())
