"""What must not be lost by accident: compare the working copy with `baseline.json`.

    python tests/baseline.py [--quick]      compare; --quick leaves out the commands

The baseline has an address for every recorded result, verdict, traceability row and page, and for
the exit status and the JSON keys of each command of `engine/benchmarks/guard.py`. An entry leaves
or changes only by an `[[entry]]` of `retired.toml`: `which` address, `old`, `new` ("gone", a value
or the address to which it moved) and `why`; a changed value names the `independent` computation.
Each `[[cut]]` there has the patterns that name what left: no file may contain them any more.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
RECORD, RETIRED = ROOT / "tests" / "baseline.json", ROOT / "tests" / "retired.toml"
MAY_NAME_CUTS = ("tests/retired.toml", "tests/baseline.json", "CHANGELOG.md")
FAMILIES = ("results", "claims", "traceability", "pages", "commands", "keys")

Entries = dict[str, Any]
"""By address: a result is {"value": ..., "error": ...}, every other entry a plain value."""


def of_files(tree: Path) -> Entries:
    """Return results, verdicts, rows and pages; all are read, nothing is computed."""
    entries = Entries()
    for file in sorted((tree / "results").glob("*.json")):
        content = json.loads(file.read_text(encoding="utf-8"))
        for claim in content.get("claims", []):
            entries[f"claims/{claim['id']}"] = claim["most_favourable"]
        for row in content.get("results", []):
            address = f"results/{file.stem}/{row['id']}"
            entries[address] = {"value": row["value"], "error": row["numerical_error"]}
    for row in (tree / "book" / "traceability.md").read_text(encoding="utf-8").splitlines():
        if label := re.search(r"`(\w+:\w+)`", row):
            names = re.search(r"chapters/(\w+)\.ipynb.*`~?([\w.]+)`.*`(test_\w+\.py::\w+)`", row)
            entries[f"traceability/{label[1]}"] = list(names.groups()) if names else row
    chapters = (f"chapters/{path.stem}" for path in (tree / "notebooks").glob("[0-9]*.md"))
    pages = (path.stem for path in (tree / "book").glob("*.md"))
    return entries | {f"pages/{name}": "a page" for name in sorted([*chapters, *pages])}


def of_commands(tree: Path, lines: list[str]) -> Entries:
    """Run command lines with a tree's package; return exit statuses and keys of JSON answers."""
    places = os.pathsep.join(str(tree / name) for name in ("src", "engine"))
    settings = {"PYTHONPATH": places, "COLUMNS": "100"}

    def answer(line: str) -> Entries:
        # An address names no program, so a command may move.
        program = "lizarraga2025" if line.partition(" ")[0] in ("claims", "results") else "cspace"
        with tempfile.TemporaryDirectory() as folder:
            words = [sys.executable, "-m", program, *line.split()]
            done = subprocess.run(
                words, cwd=folder, env=os.environ | settings, capture_output=True, check=False
            )
        found: Entries = {f"commands/{line}": done.returncode}
        if "--json" in line:
            found[f"keys/{line}"] = sorted(set(keys_of(json.loads(done.stdout))))
        return found

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return {
            address: value for each in pool.map(answer, lines) for address, value in each.items()
        }


def keys_of(content: Any, above: str = "") -> Iterator[str]:
    """Yield the path of every key of a JSON document; the entries of a list share theirs."""
    if isinstance(content, dict):
        for key, value in content.items():
            yield f"{above}{key}"
            yield from keys_of(value, f"{above}{key}.")
    elif isinstance(content, list):
        for value in content:
            yield from keys_of(value, above)


def agree(old: Any, new: Any, error: float) -> bool:
    """Tell whether two values differ by no more than an error, number by number."""
    if isinstance(old, list) and isinstance(new, list):
        return len(old) == len(new) and all(
            agree(*pair, error) for pair in zip(old, new, strict=True)
        )
    if isinstance(old, float | int) and isinstance(new, float | int):
        return type(old) is type(new) and math.isclose(old, new, rel_tol=1e-15, abs_tol=error)
    return old == new


def same(old: Any, new: Any) -> bool:
    """Tell whether an entry is as it was; a result may not become less certain."""
    if isinstance(old, dict):
        return (
            agree(old["value"], new["value"], old["error"]) and new["error"] <= 1.1 * old["error"]
        )
    return old == new


def value_of(entry: Any) -> Any:
    """Return what a line of `retired.toml` calls `old` or `new`."""
    return entry["value"] if isinstance(entry, dict) else entry


def differences(baseline: Entries, now: Entries, lines: list[dict[str, Any]]) -> Iterator[str]:
    """Yield each entry that left or changed without a line, and each line that is not true."""
    retired = {line["which"]: line for line in lines}
    for which, line in retired.items():
        if which not in baseline:
            yield f"retired.toml: {which} is not in the baseline"
        elif line["old"] != value_of(baseline[which]) or not line["why"]:
            yield f"retired.toml: {which} was {value_of(baseline[which])}; state it, and why"
    for which, old in baseline.items():
        line = retired.get(which)
        command = retired.get(which.replace("keys/", "commands/", 1), {})
        if line is None and command.get("new") == "gone":
            continue  # the keys of its answer went with it
        new = None if line is None else line["new"]
        moved = isinstance(new, str) and new.partition("/")[0] in FAMILIES
        address = new if moved else which
        if new == "gone":
            if which in now:
                yield f"{which}: retired, but still there"
        elif address not in now:
            yield f"{address}: gone, was {value_of(old)}"
        elif line is None or moved:
            if not same(old, now[address]):
                yield f"{address}: {old}, now {now[address]}"
        elif not same(old | {"value": new} if isinstance(old, dict) else new, now[which]):
            yield f"{which}: {now[which]}, not {new}, as retired.toml says"
        elif isinstance(old, dict) and not line.get("independent"):
            yield f"{which}: no independent computation is named"


def still_named(cuts: list[dict[str, Any]]) -> Iterator[str]:
    """Yield each line of the repository that names what left."""
    for cut in cuts:
        words = [word for pattern in cut["patterns"] for word in ("-e", pattern)]
        others = [f":!{name}" for name in MAY_NAME_CUTS]
        found = subprocess.run(
            ["git", "grep", "-nIE", *words, "--", ".", *others],
            cwd=ROOT, capture_output=True, text=True, check=False,
        )  # fmt: skip
        if found.returncode > 1:
            raise RuntimeError(found.stderr)
        yield from (
            f"{cut['name']} is still named: {line[:160]}" for line in found.stdout.splitlines()
        )


def compare(quick: bool) -> list[str]:
    """Return every difference of the working copy from the baseline."""
    baseline = json.loads(RECORD.read_text(encoding="utf-8"))
    retired = tomllib.loads(RETIRED.read_text(encoding="utf-8"))
    lines, cuts = retired.get("entry", []), retired.get("cut", [])
    gone = {line["which"] for line in lines if line["new"] == "gone"}
    commands = [a for a in baseline if a.startswith("commands/") and a not in gone]
    now = of_files(ROOT)
    if quick:
        baseline = {a: v for a, v in baseline.items() if not a.startswith(("commands/", "keys/"))}
        lines = [line for line in lines if line["which"] in baseline]
    else:
        now |= of_commands(ROOT, [a.partition("/")[2] for a in commands])
    return [*differences(baseline, now, lines), *still_named(cuts)]


def main() -> int:
    """Compare; return 1 if anything differs."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="leave out the commands")
    options = parser.parse_args()
    faults = compare(options.quick)
    print("\n".join(faults) or "The working copy has all of the baseline.")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
