"""Jobs of streams: many configurations at once, and one at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
import scenes
from jobs import Answers, Job
from packing import unpacked

OURS = "qbound_numpy"
COMPILED = ("qbound_compiled", "qbound_compiled_two")
BATCHES = ("pinocchio_coal", "pinocchio_coal_two")
TYPED = ("closed_form_numpy", "closed_form_numba", "closed_form_numba_two")
LOOPS = ("pinocchio_coal_loop", "python_fcl", "mujoco_contacts")
SHOWN = 3
"""Configurations judged otherwise that the file names."""


def compared(answers: Answers) -> dict[str, dict[str, Any]]:
    """Keep of each peer how many are free, and how many it judges otherwise than ours."""
    told = {name: unpacked(a["bits"], a["count"]) for name, a in answers.items()}
    ours = told.get(OURS)
    kept = {}
    for name, free in told.items():
        kept[name] = {"count": len(free), "free": int(free.sum())}
        if ours is not None and name != OURS:
            apart = np.flatnonzero(free != ours)
            kept[name] |= {"different": len(apart), "first different": apart[:SHOWN].tolist()}
    return kept


def stream(scene: str, label: str, count: int, quick: int, peers: tuple[str, ...]) -> Job:
    """Return the job of judging so many random configurations."""
    request = {"count": count, "seed": scenes.SEED}
    return Job("stream", scene, peers, request, {"count": quick}, label, compare=compared)


def one(scene: str, peers: tuple[str, ...]) -> Job:
    """Return the job of judging configurations one call each."""
    request = {"count": 5000, "seed": scenes.SEED}
    return Job("one", scene, peers, request, {"count": 1000}, compare=compared)


EVERYBODY = (OURS, *COMPILED, *BATCHES, *LOOPS, *TYPED, "shapely_points")
SINGLE = (
    OURS,
    "qbound_compiled",
    "pinocchio_coal",
    "python_fcl",
    "mujoco_contacts",
    "closed_form_numpy",
    "closed_form_numba",
)

JOBS = [
    stream("paper", "100k", 100_000, 20_000, EVERYBODY),
    stream("paper", "10m", 10_000_000, 1_000_000, (OURS, *COMPILED, *BATCHES, *TYPED)),
    stream("walls", "100k", 100_000, 20_000, EVERYBODY),
    stream("walls", "10m", 10_000_000, 1_000_000, (OURS, *COMPILED, *TYPED)),
    stream("ur5", "100k", 100_000, 5_000, (OURS, *COMPILED, *BATCHES, "mujoco_contacts")),
    stream("ur5", "10k", 10_000, 2_000, (OURS, "pinocchio_coal_loop", "python_fcl")),
    one("paper", SINGLE),
    one("walls", SINGLE),
    one("ur5", SINGLE[:5]),
]
