"""Jobs about planar regions: quality, cost against accuracy, cost against boundaries and joints."""

from __future__ import annotations

import math
from typing import Any

from closed_form import PlanarArm
from jobs import ROUNDS, Answers, Job
from quality import quality
from reference import errors, of_arcs
from scenes import SEED, configurations, robot
from streams_plan import compared

ARCS = "qbound_arcs"
OURS = (ARCS, "qbound_file", "qbound_polygons")
QUICK_ONES = ("rays", "fine_rays")
GRIDS = ("grid", "refined_grid")
FIBRES = "qbound_joints"
TYPED = "closed_form_joints"
EVERYBODY = (*OURS, *QUICK_ONES, *GRIDS)

SCENES = ("paper", "walls", "hundred", "obstacles10")
SWEPT = ("paper", "walls")
FINER = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
"""Accuracies beyond 1e-2 and 1e-3; a peer refuses what would take it over 20 s."""

BOUNDARIES = (10, 30, 100, 300)
JOINTS = (2, 3, 4, 5, 6)
MANY = 2_000_000
"""Random configurations that stand for the feasible part of joint space."""


def with_quality(scene: str) -> Any:
    """Return what puts the quality of polygons in their place, in the answers about a scene."""

    def compare(answers: Answers) -> dict[str, dict[str, Any]]:
        return {name: _judged(scene, answer) for name, answer in answers.items()}

    return compare


def _judged(scene: str, answer: dict[str, Any]) -> dict[str, Any]:
    kept = {name: value for name, value in answer.items() if name != "rings"}
    kept["all"] = quality(scene, answer["rings"])
    if "drawn" in answer:  # the answer is arcs: the polygons stand for them, but for distances
        kept["reference"] = errors(scene)
        kept["all"] |= of_arcs(kept["reference"])
    if "at" in answer:  # of the component that it is in, as that is all that it looks for
        kept["own"] = quality(scene, answer["rings"], answer["at"])
    return kept


def without_rings(answers: Answers) -> dict[str, dict[str, Any]]:
    """Drop the polygons: only how long they took is wanted."""
    return {
        name: {key: value for key, value in answer.items() if key != "rings"}
        for name, answer in answers.items()
    }


def with_error(scene: str) -> Any:
    """Return what puts errors beside feasible parts of a scene's joint space.

    They are differences from the part of many random configurations, with its standard error.
    """

    def compare(answers: Answers) -> dict[str, dict[str, Any]]:
        free = PlanarArm(robot(scene)).of(configurations(scene, MANY, SEED).T.copy()) >= 0
        true = float(free.mean())
        sure = {"true": true, "uncertain": math.sqrt(true * (1 - true) / MANY)}
        return {
            name: answer | sure | {"error": abs(answer["part"] - true)}
            for name, answer in answers.items()
        }

    return compare


def region(
    scene: str, accuracy: float, peers: tuple[str, ...], rounds: int, quick: bool = True
) -> Job:
    """Return the job of finding a region to an accuracy, rad."""
    named = tuple(name for name in peers if name != "qbound_file" or scene == "paper")
    return Job(
        "region",
        scene,
        named,
        {"accuracy": accuracy},
        {} if quick else None,
        f"{accuracy:.0e}",
        rounds,
        with_quality(scene),
    )


def grows(scene: str, peers: tuple[str, ...]) -> Job:
    """Return the job of finding a region to 1e-2, whose time alone is wanted."""
    quick = {} if scene != "boundaries-300" else None
    request = {"task": "region", "accuracy": 1e-2}
    return Job("growth", scene, peers, request, quick, "", 5, without_rings)


def joints(count: int) -> list[Job]:
    """Return the jobs about an arm of so many joints: judged, and its feasible part."""
    scene = f"joints-{count}"
    request, quick = {"count": 100_000, "seed": SEED}, {"count": 10_000}
    rough: dict[str, Any] | None = {} if count < 5 else None
    return [
        Job("stream", scene, ("qbound_numpy", TYPED), request, quick, "", 5, compared),
        Job("part", scene, (FIBRES, TYPED), {"step": 0.2}, rough, "", 3, with_error(scene)),
    ]


JOBS = [
    *(region(s, 1e-3, (*OURS, *QUICK_ONES), ROUNDS, quick=s in SWEPT) for s in SCENES),
    *(region(scene, 1e-3, GRIDS, 3, quick=False) for scene in SCENES),
    *(region(s, 1e-2, GRIDS if s in SWEPT else EVERYBODY, 3, quick=s != "hundred") for s in SCENES),
    *(region(s, 1e-1, ("alpha_shape", "alpha_arrays"), 3, quick=s in SWEPT) for s in SCENES),
    *(region(scene, 3e-2, ("alpha_arrays",), 3, quick=False) for scene in SCENES),
    *(region(scene, 1e-2, ("alpha_arrays", *OURS, *QUICK_ONES), 1, quick=False) for scene in SWEPT),
    region("walls", 3e-3, ("alpha_arrays",), 1, quick=False),
    region("walls", 3e-2, ("alpha_shape",), 1, quick=False),
    region("paper", 5e-2, ("alpha_shape",), 1, quick=False),
    region("paper", 1e-2, ("alpha_shape",), 1, quick=False),
    *(
        region(scene, accuracy, (*EVERYBODY[2:],), 1, quick=False)
        for scene in SWEPT
        for accuracy in FINER
    ),
    *(grows(f"boundaries-{count}", (ARCS, "grid", "rays")) for count in BOUNDARIES),
    *(job for count in JOINTS for job in joints(count)),
]
