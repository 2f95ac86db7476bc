"""Peers as processes: started once, asked line by line, stopped where they take too long."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PEERS = HERE / "peers"
READY = 120.0
"""Seconds that a peer may take until it is ready: libraries load, and some compile."""


def environment() -> dict[str, str]:
    """Return the environment of a peer: one thread each, our sources, nothing of the user's."""
    paths = [ROOT / "src", HERE, PEERS]
    single = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    return os.environ | {
        "PYTHONPATH": os.pathsep.join(map(str, paths)),
        "PYTHONNOUSERSITE": "1",
        **dict.fromkeys(single, "1"),
    }


class Peer:
    """One peer's process; what it cannot do comes back as an answer, never as an exception.

    Attributes
    ----------
    name : str
        Of its file, without ".py".
    about : dict
        What it said when it was ready: {"peer", "versions"} or {"peer", "missing"}.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.about: dict[str, Any] = {"peer": name}
        self._process: subprocess.Popen[str] | None = None
        self._lines: queue.Queue[str] = queue.Queue()

    def ask(self, request: dict[str, Any], limit: float) -> dict[str, Any]:
        """Return the answer to a request, or {"missing"}, {"refused"}, {"over": seconds}."""
        if self._process is None:
            self._start()
        if "missing" in self.about:
            return {"missing": self.about["missing"]}
        return self._exchange(request, limit)

    def _start(self) -> None:
        program = PEERS / f"{self.name}.py"
        if not program.exists():
            self.about["missing"] = "there is no such program"
            return
        self._process = subprocess.Popen(
            [sys.executable, program],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            env=environment(),
            cwd=ROOT,
        )
        self._lines = queue.Queue()
        threading.Thread(target=self._listen, args=(self._process,), daemon=True).start()
        self.about |= self._next(READY)
        if "over" in self.about or "refused" in self.about:
            self.about["missing"] = "it did not start"

    def _listen(self, process: subprocess.Popen[str]) -> None:
        lines = self._lines
        for line in process.stdout or ():
            lines.put(line)
        lines.put("")  # it has ended

    def _exchange(self, request: dict[str, Any], limit: float) -> dict[str, Any]:
        assert self._process is not None
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()
        except OSError:
            self.end()
            return {"refused": "its process has ended"}
        return self._next(limit)

    def _next(self, limit: float) -> dict[str, Any]:
        try:
            line = self._lines.get(timeout=limit)
        except queue.Empty:
            self.end()
            return {"over": limit}
        if not line:
            self.end()
            return {"refused": "its process has ended"}
        answer: dict[str, Any] = json.loads(line)
        return answer

    def end(self) -> None:
        """Stop the process; the next request starts it anew."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._process = None
