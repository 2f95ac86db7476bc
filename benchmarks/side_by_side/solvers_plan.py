"""Jobs of the solvers: Drake's IRIS and C-IRIS, Codac's pavings, and our own proofs."""

from __future__ import annotations

from certified import with_share
from jobs import FEWER, ROUNDS, Job
from planar_plan import with_quality

LIGHT = ("walls", "paper")
"""Scenes in which each variant takes a few seconds at most."""

VARIANTS = ("zo", "np2", "np")
SEEDS = 10

SIZES = {
    ("paper", 1.0): 0.042,
    ("paper", 0.1): 0.0099,
    ("walls", 1.0): 0.06,
    ("walls", 0.1): 0.0061,
    ("three", 10.0): 0.14,
    ("three", 1.0): 0.014,
}
"""Sizes of Codac's boxes that leave so many per cent undecided: found before, tried first."""


def iris(scene: str, variant: str, count: int, rounds: int, quick: bool) -> Job:
    """Return the job of growing a polytope about home, or about so many places."""
    request = {"variant": variant, "count": count}
    label = f"{variant}-{count}"
    peers, trial = ("drake_iris",), {} if quick else None
    return Job("iris", scene, peers, request, trial, label, rounds, with_quality(scene))


def cover(scene: str, rounds: int, quick: bool) -> Job:
    """Return the job of covering the free space by polytopes."""
    trial = {} if quick else None
    return Job("cover", scene, ("drake_iris",), {}, trial, "", rounds, with_quality(scene))


def paving(scene: str, per_cent: float, rounds: int, quick: bool) -> Job:
    """Return the job of paving until so much of the joint box is undecided."""
    peers = "qbound_paving", "codac_paving"
    request = {"undecided": per_cent / 100, "eps": SIZES[scene, per_cent]}
    trial = {} if quick else None
    return Job("paving", scene, peers, request, trial, f"{per_cent:g}", rounds)


def certify(scene: str) -> Job:
    """Return the job of proving a part of home's component, as large as each can."""
    peers = ("qbound_certificate", "drake_ciris")
    request, trial = {"iterations": 10}, {"iterations": 2}
    return Job("certify", scene, peers, request, trial, "", FEWER, with_share(scene))


def longer(scene: str, iterations: int) -> Job:
    """Return the job of C-IRIS with more steps than it takes as it comes."""
    request = {"iterations": iterations}
    compare = with_share(scene)
    return Job("certify", scene, ("drake_ciris",), request, None, str(iterations), 1, compare)


def checked(task: str, scene: str) -> Job:
    """Return the job of checking our certificate, by one of the two checkers."""
    return Job(task, scene, ("qbound_certificate",), {}, {}, "", ROUNDS, with_share(scene))


JOBS = [
    *(iris(scene, variant, 1, FEWER, True) for scene in LIGHT for variant in VARIANTS),
    *(iris("obstacles10", variant, 1, 1, False) for variant in VARIANTS),
    iris("hundred", "zo", 1, 1, False),
    *(iris(scene, variant, SEEDS, 1, False) for scene in LIGHT for variant in VARIANTS),
    *(cover(scene, 1, scene == "walls") for scene in (*LIGHT, "obstacles10")),
    *(paving(scene, 1.0, ROUNDS, True) for scene in LIGHT),
    *(paving(scene, 0.1, ROUNDS, True) for scene in LIGHT),
    paving("three", 10.0, 1, False),
    paving("three", 1.0, 1, False),
    *(certify(scene) for scene in LIGHT),
    longer("walls", 50),
    *(checked(task, scene) for task in ("check", "alone") for scene in LIGHT),
]
