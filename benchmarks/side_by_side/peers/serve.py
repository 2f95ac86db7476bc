"""The loop of a peer: one line of JSON for each line of JSON, until the input ends.

A peer is a program of its own. When it is ready it says so, with versions, or what is missing::

    {"peer": "pinocchio + coal", "versions": {"pin": "4.1.0"}}
    {"peer": "...", "missing": "No module named 'pinocchio'"}

Then each request, such as ``{"task": "stream", "scene": "paper", "count": 1000, "seed": 1}``, gets
``{"seconds": wall, "processor": cpu, "answer": {...}}``, ``{"missing": "why"}``, or
``{"refused": "why"}``. What a library prints goes to standard error.
"""

from __future__ import annotations

import importlib
import importlib.metadata
import json
import os
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

Timed = tuple[float, float, Any]
Task = Callable[..., Timed]


class Missing(Exception):
    """Something that the task needs is not installed, or the peer has no such thing."""


class Refused(Exception):
    """The peer will not or cannot do this: why."""


def timed(work: Callable[[], Any]) -> Timed:
    """Call once; return wall seconds, processor seconds, and what it gave."""
    wall, processor = time.perf_counter(), time.process_time()
    answer = work()
    return time.perf_counter() - wall, time.process_time() - processor, answer


def serve(peer: str, needs: Mapping[str, str], tasks: Mapping[str, Task]) -> None:
    """Answer requests until the input ends.

    Parameters
    ----------
    peer : str
        What the table calls it.
    needs : mapping of str to str
        What it imports, each with the name of its distribution, whose version is told.
    tasks : mapping of str to callable
        Each gets the request, without "task", as keywords. It makes what it needs once (cached),
        times the work alone (`timed`), and returns wall seconds, processor seconds, answer.
    """
    say = _own_output()
    try:
        for module in needs:
            importlib.import_module(module)
        versions = {name: importlib.metadata.version(name) for name in needs.values()}
    except Exception as error:  # a library may fail in any way while it loads
        say({"peer": peer, "missing": why_not(needs.values()) or str(error)})
        return
    say({"peer": peer, "versions": versions})
    for line in sys.stdin:
        say(_answer(tasks, json.loads(line)))


def why_not(packages: Iterable[str]) -> str:
    """Return which of some packages could not be installed, and why; nothing if all could."""
    absent = not_installed()
    return "; ".join(
        f"{name}: not installed ({absent[name]})" for name in packages if name in absent
    )


def not_installed() -> dict[str, str]:
    """Return what of the lock `run.py bench` could not install, each with the reason."""
    file = Path(sys.prefix, "not-installed.json")
    found: dict[str, str] = json.loads(file.read_text("utf-8")) if file.exists() else {}
    return found


def _answer(tasks: Mapping[str, Task], request: dict[str, Any]) -> dict[str, Any]:
    name = request.pop("task")
    if name not in tasks:
        return {"missing": f"no task {name}"}
    try:
        seconds, processor, answer = tasks[name](**request)
    except (Missing, ImportError) as error:
        return {"missing": str(error)}
    except Refused as error:
        return {"refused": str(error)}
    except Exception as error:  # told, and the peer goes on
        traceback.print_exc()
        return {"refused": f"{type(error).__name__}: {error}"}
    return {"seconds": seconds, "processor": processor, "answer": answer}


def _own_output() -> Callable[[dict[str, Any]], None]:
    """Keep standard output for the answers: what else is printed goes to standard error."""
    output = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)

    def say(answer: dict[str, Any]) -> None:
        output.write(json.dumps(answer) + "\n")
        output.flush()

    return say
