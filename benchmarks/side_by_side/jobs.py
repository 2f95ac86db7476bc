"""What is asked of whom: one job is one request to several peers, in turns, round by round."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

Answers = Mapping[str, dict[str, Any]]
"""The answer of each peer to the same request, of one round."""

ROUNDS = 7
FEWER = 3
"""Rounds where one answer takes over `LONG` seconds."""

LONG = 20.0
LIMIT = 120.0
"""Seconds after which a peer is stopped and reported as over the time."""


def as_they_are(answers: Answers) -> dict[str, dict[str, Any]]:
    """Keep every answer as it is."""
    return dict(answers)


@dataclass(frozen=True)
class Job:
    """One request, to several peers in turns.

    Attributes
    ----------
    task, scene : str
        With the peer's name they are the measurement's id.
    peers : tuple of str
        Their programs: names of files in peers/, without ".py".
    request : dict
        What the peers get beside task and scene; "task" in it stands for another task's name.
    quick : dict or None
        What of the request is otherwise in a trial run; None leaves the job out of one.
    label : str
        What tells jobs of one task and scene apart, in the id.
    rounds : int
        At most so many; the trial run has two.
    compare : callable
        From the answers of all peers to what the file keeps of each: here they are compared.
    """

    task: str
    scene: str
    peers: tuple[str, ...]
    request: dict[str, Any] = field(default_factory=dict)
    quick: dict[str, Any] | None = field(default_factory=dict)
    label: str = ""
    rounds: int = ROUNDS
    compare: Callable[[Answers], dict[str, dict[str, Any]]] = as_they_are

    def line(self, quick: bool) -> dict[str, Any]:
        """Return the request as it is sent."""
        changes = (self.quick or {}) if quick else {}
        return {"task": self.task, "scene": self.scene} | self.request | changes

    def id_of(self, peer: str) -> str:
        """Return the id of the measurement of one peer."""
        parts = [self.task, self.scene, self.label, peer.replace("_", "-")]
        return "-".join(part for part in parts if part)
