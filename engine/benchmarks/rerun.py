"""Measure a chapter that runs inside its page: seconds from the click, megabytes, memory.

    .venv/bin/python engine/benchmarks/rerun.py [HTML]

Chromium opens chapter 7 from the file system, without a network, after `python3 run.py live`. The
result is written to `rerun.json` beside this file. Memory is the proportional set size of the
browser's processes (Linux), less what it was before the click.
"""

from __future__ import annotations

import json
import os
import platform
import shutil
import sys
import time
from pathlib import Path
from typing import Any

from playwright.sync_api import Page, sync_playwright

HERE = Path(__file__).resolve().parent
HTML = HERE.parents[1] / "book" / "_build" / "html"
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-sync"]
SAID = "document.querySelector('.rerun-said').textContent"


def memory(root: int) -> float:
    """Return the proportional set size of a process and all below it, MB."""
    parents = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            parents[int(stat.parent.name)] = int(stat.read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
    family = {root}
    while more := {pid for pid, parent in parents.items() if parent in family} - family:
        family |= more
    sizes = []
    for pid in family:
        try:
            rollup = Path(f"/proc/{pid}/smaps_rollup").read_text()
        except OSError:
            continue
        sizes += [int(line.split()[1]) for line in rollup.splitlines() if line.startswith("Pss:")]
    return sum(sizes) / 1000


def wait(page: Page, expression: str) -> None:
    """Ask until it is true: the page's policy refuses what Playwright would put into it to wait."""
    while not page.evaluate(expression):
        time.sleep(0.05)


def measured(html: Path) -> dict[str, Any]:
    chapter = next((html / "chapters").glob("[0-9][0-9]_region.html"))
    listed = (html / "_static" / "rerun-files.js").read_text(encoding="utf-8")
    files = json.loads(listed[listed.index("{") : listed.rindex("}") + 1])["files"]
    size: dict[str, float] = {}
    for file in files:
        size[file["part"]] = size.get(file["part"], 0) + file["bytes"] / 1e6
    with sync_playwright() as run:
        program = shutil.which("chromium") or shutil.which("chromium-browser")
        browser = run.chromium.launch(executable_path=program, args=FLAGS)
        page = browser.new_context(offline=True).new_page()
        page.set_default_timeout(900_000)
        page.goto(chapter.as_uri())
        before, start = memory(os.getpid()), time.perf_counter()
        page.click(".rerun-start")
        seconds = {}
        steps = {
            "python runs": f"/Running cell/.test({SAID})",
            "first region": "document.querySelector('.rerun-output[data-cell=\"6\"]') !== null",
            "all cells": f"/numbers agree/.test({SAID})",
        }
        for name, expression in steps.items():
            wait(page, expression)
            seconds[name] = round(time.perf_counter() - start, 1)
        taken = memory(os.getpid()) - before
        page.click(".rerun-start")
        start = time.perf_counter()
        wait(page, f"!/numbers agree/.test({SAID})")
        wait(page, f"/numbers agree/.test({SAID})")
        seconds["again"] = round(time.perf_counter() - start, 1)
        version = browser.version
        browser.close()
    return {
        "page": chapter.name,
        "browser": f"Chromium {version}",
        "machine": f"{platform.machine()}, {os.cpu_count()} cores",
        "load": round(os.getloadavg()[0], 1),
        "seconds_from_click": seconds,
        "memory_MB": round(taken),
        "read_MB": {part: round(value, 1) for part, value in sorted(size.items())},
    }


if __name__ == "__main__":
    found = measured(Path(sys.argv[1]) if len(sys.argv) > 1 else HTML)
    (HERE / "rerun.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(found, indent=1))
