"""Ask all peers, and write what they answered: `python3 run.py bench [--quick]` calls this.

One file comes out, ``benchmarks/side_by_side.json``: the machine, versions, every measurement
(median, lowest and highest of its rounds), and every goal, met or missed.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from statistics import median
from typing import Any

from asking import ROOT, Peer
from goals import judged
from jobs import FEWER, LIMIT, LONG, Job
from machine import load, machine
from plan import JOBS

SCHEMA = "qbound/side-by-side/1"
FILE = ROOT / "benchmarks" / "side_by_side.json"
QUICK_ROUNDS = 2
TOO_LATE = {"missing": "not asked: the time of the run was up"}


def main() -> int:
    options = command_line()
    if options.judge:
        told = json.loads(options.output.read_text(encoding="utf-8"))
        write(told | {"goals": judged(told["measurements"])}, options.output)
        return 0
    told = asked([job for job in JOBS if is_chosen(job, options)], options)
    write(told, options.output)
    print(f"{options.output}: {len(told['measurements'])} measurements in {told['seconds']} s")
    return 0


def command_line() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a trial run: less of everything")
    parser.add_argument("--only", default="", help="jobs whose task and scene hold this")
    parser.add_argument("-o", "--output", type=Path, default=FILE)
    parser.add_argument("--minutes", type=float, help="ask nothing more after so many")
    parser.add_argument("--judge", action="store_true", help="judge the goals of the file again")
    return parser.parse_args()


def is_chosen(job: Job, options: argparse.Namespace) -> bool:
    named = options.only in f"{job.task}-{job.scene}-{job.label}"
    return named and not (options.quick and job.quick is None)


def asked(jobs: list[Job], options: argparse.Namespace) -> dict[str, Any]:
    """Ask everybody, and return the document."""
    peers = {name: Peer(name) for job in jobs for name in job.peers}
    start, busy, measurements = time.monotonic(), load(), list[dict[str, Any]]()
    for job in jobs:
        if options.minutes is None or time.monotonic() - start < 60 * options.minutes:
            measurements += measured(job, peers, options.quick)
        else:
            measurements += [entry(job, peers[name], [TOO_LATE], None) for name in job.peers]
    for peer in peers.values():
        peer.end()
    return {
        "schema": SCHEMA,
        "date": datetime.now(UTC).date().isoformat(),
        "quick": options.quick,
        "seconds": round(time.monotonic() - start),
        "machine": machine() | {"load before": busy},
        "peers": [about(peer) for peer in peers.values()],
        "measurements": measurements,
        "goals": judged(measurements),
    }


def measured(job: Job, peers: dict[str, Peer], quick: bool) -> list[dict[str, Any]]:
    """Ask the peers of a job in turns, round by round, and put together what each answered."""
    answers: dict[str, list[dict[str, Any]]] = {name: [] for name in job.peers}
    for number in range(min(QUICK_ROUNDS, job.rounds) if quick else job.rounds):
        for name in job.peers:
            if wants_more(answers[name], number, quick):
                answers[name].append(peers[name].ask(job.line(quick), LIMIT))
        print(f"{job.id_of('')}: round {number + 1}", file=sys.stderr, flush=True)
    first = {name: rounds[0]["answer"] for name, rounds in answers.items() if timed(rounds)}
    kept = job.compare(first)
    return [entry(job, peers[name], rounds, kept.get(name)) for name, rounds in answers.items()]


def timed(rounds: list[dict[str, Any]]) -> bool:
    return bool(rounds) and all("seconds" in answer for answer in rounds)


def wants_more(rounds: list[dict[str, Any]], number: int, quick: bool) -> bool:
    """Tell whether a peer is asked again: not after a failure, and less where it takes long."""
    if not rounds:
        return True
    if not timed(rounds):
        return False
    slow = max(answer["seconds"] for answer in rounds) > LONG
    return number < (1 if quick else FEWER) if slow else True


def entry(job: Job, peer: Peer, rounds: list[dict[str, Any]], kept: Any) -> dict[str, Any]:
    """Return one measurement: median, lowest, highest of wall time, and what was answered."""
    about = {
        "id": job.id_of(peer.name),
        "task": job.task,
        "scene": job.scene,
        "label": job.label,
        "peer": peer.about["peer"],
    }
    if not timed(rounds):
        last = rounds[-1]
        return about | {name: last[name] for name in ("missing", "refused", "over") if name in last}
    seconds = [answer["seconds"] for answer in rounds]
    return about | {
        "seconds": median(seconds),
        "low": min(seconds),
        "high": max(seconds),
        "processor": median(answer["processor"] for answer in rounds),
        "rounds": seconds,
        "answer": kept,
    }


def about(peer: Peer) -> dict[str, Any]:
    return {"program": peer.name} | peer.about


def write(document: dict[str, Any], file: Path) -> None:
    """Write aside, then take the old file's place: it is whole, or it is the old one."""
    draft = file.with_name(f".{file.name}.new")
    text = json.dumps(document, indent=1, allow_nan=False)
    draft.write_text(text + "\n", encoding="utf-8", newline="\n")
    draft.replace(file)


if __name__ == "__main__":
    sys.exit(main())
