"""Peers as processes: started once, asked in turns, stopped where they take too long."""

from __future__ import annotations

import multiprocessing
import os
import time
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

Timed = tuple[float, float, Any]
"""Wall seconds, processor seconds, and what was answered."""

SPAWN = multiprocessing.get_context("spawn")


def timed(work: Callable[[], Any]) -> Timed:
    """Call once; return wall seconds, processor seconds, and what it gave."""
    wall, processor = time.perf_counter(), time.process_time()
    answer = work()
    return time.perf_counter() - wall, time.process_time() - processor, answer


class Asked:
    """The process of one peer; what it cannot do comes back as an answer, never as an exception."""

    def __init__(self, function: Callable[..., Timed]) -> None:
        self.function = function
        self._process: Any = None

    def ask(self, request: dict[str, Any], limit: float) -> dict[str, Any]:
        """Return what was answered, or {"missing": why}, {"refused": why}, {"over": seconds}."""
        if self._process is None:
            self._pipe, theirs = SPAWN.Pipe()
            self._process = SPAWN.Process(target=serve, args=(theirs, self.function), daemon=True)
            self._process.start()
            theirs.close()
        try:
            self._pipe.send(request)
            if self._pipe.poll(limit):
                answer: dict[str, Any] = self._pipe.recv()
                return answer
            answer = {"over": limit}
        except (EOFError, OSError):
            answer = {"refused": "its process has ended"}
        self.end()
        return answer

    def end(self) -> None:
        """Stop the process; the next request starts it anew."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None


def serve(pipe: Connection, function: Callable[..., Timed]) -> None:
    """Answer requests until the pipe is closed; what a library prints goes to standard error."""
    os.dup2(2, 1)
    while True:
        try:
            request = pipe.recv()
        except EOFError:
            return
        try:
            seconds, processor, answer = function(**request)
            pipe.send({"seconds": seconds, "processor": processor, "answer": answer})
        except ImportError as error:
            pipe.send({"missing": str(error)})
        except Exception as error:  # told, and the peer goes on
            traceback.print_exc()
            pipe.send({"refused": f"{type(error).__name__}: {error}"})
