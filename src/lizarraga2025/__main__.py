"""The command, and ``python -m lizarraga2025``; imports run where Ctrl-C is handled."""

import sys


def start() -> int:
    """Run the command that was typed; return 130 if it is stopped, even while it is loading."""
    try:
        from lizarraga2025.commands import main

        return main()
    except KeyboardInterrupt:
        print("lizarraga2025: stopped", file=sys.stderr)  # noqa: T201
        return 130


if __name__ == "__main__":
    sys.exit(start())
