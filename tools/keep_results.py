"""Keep the recorded results with which this machine's arithmetic agrees, and name them.

    python tools/keep_results.py NEW OLD

On a kind of processor other than the book's, the last digits of a number may differ. Where a result
in a file of the folder NEW agrees with the one recorded in OLD, within the error that is stated
there, the entry of OLD stays, value and error. Each entry that stays is named, with its difference
as a share of the error. Each entry that does not agree is named too, and replaces the old one.
"""

import json
import sys
from pathlib import Path
from typing import Any

from lizarraga2025.results import share_of_error

Content = dict[str, Any]


def settled(new: Content, old: Content) -> tuple[Content, list[str]]:
    """Return a file's content with the old entries that agree, and a line for each difference."""
    before = {entry["id"]: entry for entry in old["results"]}
    entries, lines = [], []
    for entry in new["results"]:
        then = before.get(entry["id"])
        share = 0.0 if then is None else share_of_error(entry, then)
        agrees = then is not None and share <= 1
        entries.append(then if agrees else entry)
        if then is not None and entry != then:
            said = "kept, differs by" if agrees else "NOT THE RECORDED ONE, differs by"
            lines.append(f"{new['chapter']}/{entry['id']}: {said} {share:.2g} of its error")
    return new | {"results": entries}, lines


def main(new: Path, old: Path) -> int:
    for file in sorted(new.glob("*.json")):
        recorded = old / file.name
        content = json.loads(file.read_text(encoding="utf-8"))
        if not recorded.exists() or "results" not in content:
            continue
        content, lines = settled(content, json.loads(recorded.read_text(encoding="utf-8")))
        text = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
        file.write_text(text, encoding="utf-8", newline="\n")
        print("\n".join(lines), end="\n" if lines else "")
    return 0


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:])))
