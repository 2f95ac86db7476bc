"""``lizarraga2025 cite``: how to cite the paper and the package."""

import argparse
from typing import Any

from lizarraga2025.ledger import cite


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "cite",
        help="how to cite paper and package, in BibTeX",
        description="Print the BibTeX entries of the paper and of this package. With --bibtex\n"
        "claims and results print theirs alone, so that one file can hold them all.",
        epilog="example: lizarraga2025 cite",
    )
    parser.set_defaults(run=run)


def run(_: argparse.Namespace) -> int:
    """Print both entries."""
    print(f"{cite.PAPER}\n\n{cite.package()}\n")
    return 0
