"""``lizarraga2025 results``: the numbers that the book states, as recorded."""

import argparse
import json
from contextlib import suppress
from typing import Any

from lizarraga2025 import recorded
from lizarraga2025.ledger import cite
from lizarraga2025.measured import side_by_side

Entry = dict[str, Any]

ABOUT_THE_FILE = ("version", "robots")


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "results",
        help="every number that the book states",
        description="Print recorded numbers, each with what it is: all, those of a chapter, that of"
        " an id, or those in whose id or description a word occurs.",
        epilog="example: lizarraga2025 results paper.area --bibtex\n"
        "example: lizarraga2025 results centroid",
    )
    parser.add_argument(
        "names", nargs="*", metavar="ID|WORD", help="vertex.1, region/vertex.1, region/, centroid"
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="as in results/, with the chapter")
    form.add_argument("--bibtex", action="store_true", help="BibTeX entries of these results")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Print the chosen numbers."""
    entries = recorded.results()
    of_name = {name: _found(entries, name) for name in options.names or [""]}
    for name in [name for name, found in of_name.items() if not found]:
        went = _measured(name) or "`lizarraga2025 results` lists all"
        raise ValueError(f"no result {name!r}; {went}")
    chosen = [entry for entry in entries if any(entry in found for found in of_name.values())]
    if options.json:
        plain = [{k: v for k, v in entry.items() if k not in ABOUT_THE_FILE} for entry in chosen]
        print(json.dumps(plain, indent=1, ensure_ascii=False))
    elif options.bibtex:
        cited = [cite.result(entry) for entry in recorded.distinct(chosen)]
        print("\n\n".join(cited) + "\n")
    else:
        for entry in chosen:
            print(_line(entry))
    return 0


def _line(entry: Entry) -> str:
    """Return id, value, both errors, unit, what the number belongs to, and what it is."""
    unit = "" if entry["unit"] == "1" else f" {entry['unit']}"
    error = f" ± {entry['numerical_error']:g}" if entry["numerical_error"] else ""
    value = f"{cite.value_text(entry['value'])}{error}{unit}"
    about = f"  ({told})" if (told := recorded.about(entry)) else ""
    first = f"{entry['chapter']}/{entry['id']} = {value}{about}"
    bound = entry["input_uncertainty"]
    open_ = [f"the printed digits leave ± {bound:g}{unit} open"] if bound else []
    lines = [recorded.sentence(entry["id"]), "; ".join([*open_, *recorded.left_open(entry)])]
    return "\n    ".join([first, *filter(None, lines)])


def _found(entries: list[Entry], name: str) -> list[Entry]:
    """Return the entries of an id or chapter; where there is none, those in which a word occurs."""
    named, with_word = [], []
    for entry in entries:
        chapter, texts = entry["chapter"], (entry["id"], entry["reference"])
        if name in ("", entry["id"], f"{chapter}/{entry['id']}", f"{chapter}/"):
            named.append(entry)
        if name.casefold() in "\n".join((*texts, recorded.sentence(entry["id"]))).casefold():
            with_word.append(entry)
    return named or with_word


def _measured(name: str) -> str:
    """Say where the measurement is that had this id among the results; nothing of any other id."""
    measurement, _, what = name.rpartition("/")[2].removeprefix("side.").rpartition(".")
    with suppress(FileNotFoundError):  # an installation may carry no measurements
        for one in (one for one in side_by_side().measurements if one.id == measurement):
            told = f"; its time is {one.seconds:.3g} s" if what == "time" and one.seconds else ""
            return f"it was measured: {measurement!r} in engine/benchmarks/side_by_side.json{told}"
    return ""
