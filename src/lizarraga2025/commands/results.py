"""``qbound results``: the numbers that the book states, as recorded."""

from __future__ import annotations

import argparse
import json
from typing import Any

from lizarraga2025 import recorded
from lizarraga2025.ledger import cite

ABOUT_THE_FILE = ("version", "robots")


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "results",
        help="every number that the book states",
        description="Print recorded numbers: all, those of a chapter, or those of an id.",
        epilog="example: qbound results paper.area --bibtex",
    )
    parser.add_argument("ids", nargs="*", metavar="ID", help="vertex.1, region/vertex.1, region/")
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="as in results/, with the chapter")
    form.add_argument("--bibtex", action="store_true", help="how to cite paper, package, results")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Print the chosen numbers."""
    entries = recorded.results()
    names = options.ids or [""]
    lost = [name for name in names if not any(_is_named(entry, name) for entry in entries)]
    if lost:
        raise ValueError(f"no result {lost[0]!r}; `qbound results` lists all")
    chosen = [entry for entry in entries if any(_is_named(entry, name) for name in names)]
    if options.json:
        plain = [{k: v for k, v in entry.items() if k not in ABOUT_THE_FILE} for entry in chosen]
        print(json.dumps(plain, indent=1, ensure_ascii=False))
    elif options.bibtex:
        cited = [cite.result(entry) for entry in recorded.distinct(chosen)]
        print("\n\n".join([cite.PAPER, cite.package(), *cited]))
    else:
        for entry in chosen:
            print(_line(entry))
    return 0


def _line(entry: dict[str, Any]) -> str:
    """Return id, value, unit, error, and what the number is about."""
    unit = "" if entry["unit"] == "1" else f" {entry['unit']}"
    error = f" ± {entry['error']:g}" if entry["error"] else ""
    value = f"{cite.value_text(entry['value'])}{error}{unit}"
    return f"{entry['chapter']}/{entry['id']} = {value}{_about(entry)}"


def _is_named(entry: dict[str, Any], name: str) -> bool:
    """Tell whether a name is the entry's id, its chapter with a slash, both, or nothing."""
    whole = f"{entry['chapter']}/{entry['id']}"
    return name in ("", entry["id"], whole, f"{entry['chapter']}/")


def _about(entry: dict[str, Any]) -> str:
    rule = "" if entry["rule"] == "none" else f"{entry['rule']} rule"
    words = [word for word in (entry["reference"], rule) if word]
    return f"  ({', '.join(words)})" if words else ""
