"""Ask all peers, and write what they answered: `python3 run.py bench [--quick]` calls this.

One file comes out, ``engine/benchmarks/side_by_side.json``: the machine, versions, every
measurement (median, lowest and highest of its rounds), and every goal, met or missed. Requests that
are made no longer stay in it, each with the date of its last measurement. A trial run, or a run of
some jobs alone, writes a file only where one is named.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import time
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from statistics import median
from typing import Any

from asking import Asked
from goals import judged
from quality import compared
from table import JOBS, PEERS, THEIRS, Job, Row

SCHEMA = "qbound/side-by-side/1"
FILE = Path(__file__).resolve().parents[1] / "side_by_side.json"
QUICK_ROUNDS = 2
FEWER, LONG = 3, 20.0
"""Rounds where one answer takes over so many seconds."""
LIMIT = 120.0
"""Seconds after which a peer is stopped and reported as over the time."""
ONE_THREAD = ("OMP", "OPENBLAS", "MKL", "DRAKE")


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a trial run: less of everything")
    parser.add_argument("--only", default="", help="jobs whose task, scene and label hold this")
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    os.environ.update({f"{name}_NUM_THREADS": "1" for name in ONE_THREAD}, PYTHONNOUSERSITE="1")
    jobs = [
        job
        for job in JOBS
        if options.only in f"{job.task}-{job.scene}-{job.label}"
        and not (options.quick and job.quick is None)
    ]
    told = asked(jobs, options.quick)
    output = options.output or (None if options.quick or options.only else FILE)
    if output is not None:
        write(told, output)
    print("\n".join(table(told["measurements"])))
    return 0


def asked(jobs: list[Job], quick: bool) -> dict[str, Any]:
    """Ask everybody, and return the document."""
    rows = {row.function: row for row in PEERS}
    peers = {function: Asked(function) for function in rows}
    start, busy, found = time.monotonic(), load(), list[dict[str, Any]]()
    for job in jobs:
        found += measured(job, rows, peers, quick)
    for peer in peers.values():
        peer.end()
    before = json.loads(FILE.read_text(encoding="utf-8"))
    by_id = {each["id"]: each for each in found}
    return {
        "schema": SCHEMA,
        "date": datetime.now(UTC).date().isoformat(),
        "quick": quick,
        "seconds": round(time.monotonic() - start),
        "machine": machine() | {"load before": busy},
        "peers": [{"peer": row.name, "versions": versions(row)} for row in PEERS],
        "measurements": found,
        "retired": before["retired"],
        "goals": [judged(goal, by_id) for goal in before["goals"]],
    }


def measured(job: Job, rows: Any, peers: Any, quick: bool) -> list[dict[str, Any]]:
    """Ask the peers of a job in turns, round by round, and put together what each answered."""
    request = {"task": job.task, "scene": job.scene} | job.request
    request |= (job.quick or {}) if quick else {}
    rounds: dict[Any, list[dict[str, Any]]] = {function: [] for function in job.functions}
    for number in range(min(QUICK_ROUNDS, job.rounds) if quick else job.rounds):
        for function, before in rounds.items():
            slow = max((each.get("seconds", 0.0) for each in before), default=0.0) > LONG
            silent = any("seconds" not in each for each in before)
            if not silent and not (slow and number >= (1 if quick else FEWER)):
                before.append(peers[function].ask(request, LIMIT))
        print(
            f"{job.task}-{job.scene}-{job.label}: round {number + 1}", file=sys.stderr, flush=True
        )
    timed = {f: found for f, found in rounds.items() if all("seconds" in each for each in found)}
    kept = compared(job.scene, {f.__name__: found[0]["answer"] for f, found in timed.items()})
    result = []
    for function, found in rounds.items():
        told = {"id": job.id_of(function), "task": job.task, "scene": job.scene}
        told |= {"label": job.label, "peer": rows[function].name}
        if function in timed:
            seconds = [each["seconds"] for each in found]
            told |= {"seconds": median(seconds), "low": min(seconds), "high": max(seconds)}
            told |= {"processor": median(each["processor"] for each in found), "rounds": seconds}
            told |= {"answer": kept[function.__name__]}
        else:
            told |= found[-1]
        result.append(told)
    return result


def table(found: list[dict[str, Any]]) -> list[str]:
    """Return the lines of a table: every measurement, then every peer with what it answered."""
    lines = ["", "| task | scene | peer | time / s | |", "| --- | --- | --- | --- | --- |"]
    for each in found:
        answer = each.get("answer", {})
        told = answer.get("own", answer.get("all", answer))
        words = ("different", "distance", "covered", "beyond", "undecided", "count")
        notes = [f"{word} {told[word]:.3g}" for word in words if told.get(word) is not None]
        notes += [
            f"{word}: {each[word]}" for word in ("missing", "refused", "over") if word in each
        ]
        took = f"{each['seconds']:.3g}" if "seconds" in each else ""
        task = f"{each['task']} {each['label']}".strip()
        lines.append(f"| {task} | {each['scene']} | {each['peer']} | {took} | {', '.join(notes)} |")
    lines += ["", "| peer | library | what it answers | answers |", "| --- | --- | --- | --- |"]
    for row in THEIRS:
        asked = [each for each in found if each["peer"] == row.name]
        why = next((each["missing"] for each in asked if "missing" in each), "")
        count = f"{sum('seconds' in each for each in asked)} of {len(asked)}"
        library = ", ".join(f"{name} {number}" for name, number in versions(row).items())
        answered = f"missing: {why}" if why else count
        lines.append(f"| {row.name} | {library or row.libraries} | {row.answers} | {answered} |")
    return lines


def versions(row: Row) -> dict[str, str]:
    """Return the versions of a peer's libraries, as far as they are installed."""
    found = {}
    for name in row.libraries.split():
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def machine() -> dict[str, Any]:
    """Return what is measured on: no names of hosts or persons."""
    memory = proc("/proc/meminfo", "MemTotal")
    return {
        "processor": proc("/proc/cpuinfo", "model name") or platform.processor() or "unknown",
        "cores": os.cpu_count(),
        "memory": int(memory.split()[0]) * 1024 if memory else 0,
        "system": f"{platform.system()} {platform.release().split('-')[0]}",
        "architecture": platform.machine(),
        "python": platform.python_version(),
        "compiler": sys.implementation.name,
    }


def proc(file: str, name: str) -> str:
    """Return what the system tells in one of its files, or nothing where there is none."""
    lines = Path(file).read_text(encoding="utf-8").splitlines() if Path(file).exists() else []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith(name)), "")


def load() -> float | None:
    """Return how many processes were ready to run over the last minute."""
    return round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else None


def write(document: dict[str, Any], file: Path) -> None:
    """Write aside, then take the old file's place: it is whole, or it is the old one."""
    draft = file.with_name(f".{file.name}.new")
    text = json.dumps(document, indent=1, allow_nan=False)
    draft.write_text(text + "\n", encoding="utf-8", newline="\n")
    draft.replace(file)


if __name__ == "__main__":
    sys.exit(main())
