"""Who is asked, and what: one row a peer, one row a job."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from asking import Timed
from drake_polytopes import drake_ciris, drake_iris_np2, drake_iris_zo
from judges import (
    closed_form_numba,
    mujoco_contacts,
    pinocchio_coal,
    python_fcl,
    qbound_compiled,
    qbound_compiled_two,
    qbound_numpy,
    shapely_points,
)
from limits import limits
from outlines import alpha_shape, qbound_arcs, rays
from proofs import codac_paving, qbound_cells, qbound_certificate


@dataclass(frozen=True)
class Row:
    """One peer.

    Attributes
    ----------
    name : str
    libraries : str
        Distributions whose versions are told, with spaces between them.
    answers : str
        What the peer answers, in words.
    function : callable
        Gets task, scene and request; prepares, and returns wall seconds and processor seconds of
        the work alone, and its answer. It imports its library itself, so one that cannot be
        imported is reported as missing and stops nobody else.
    """

    name: str
    libraries: str
    answers: str
    function: Callable[..., Timed]


JUDGED, TO_ACCURACY = "is a configuration free?", "boundary of a region, to an accuracy"
GROWN, PAVED = "a convex part of a region, sampled", "cells proved inside or outside"
PROVED = "a part of a region, proved"

OURS = (
    Row("qbound, NumPy", "numpy", JUDGED, qbound_numpy),
    Row("qbound, compiled", "numba", JUDGED, qbound_compiled),
    Row("qbound, compiled, two threads", "numba", JUDGED, qbound_compiled_two),
    Row("qbound, arcs", "numpy", "boundary of a region, exact", qbound_arcs),
    Row("qbound, paving by cells", "numpy", PAVED, qbound_cells),
    Row("qbound, certificate", "numpy", PROVED, qbound_certificate),
)
THEIRS = (
    Row("pinocchio + coal", "pin coal", JUDGED, pinocchio_coal),
    Row("python-fcl", "python-fcl", JUDGED, python_fcl),
    Row("MuJoCo", "mujoco", JUDGED, mujoco_contacts),
    Row("shapely, prepared polygons", "shapely", JUDGED, shapely_points),
    Row("closed form typed by hand, numba", "numba", JUDGED, closed_form_numba),
    Row("the machine's limit", "numba", "how fast memory is read, and sines taken", limits),
    Row("ray bisection", "numpy", TO_ACCURACY, rays),
    Row("sampling + alpha shape", "alphashape", TO_ACCURACY, alpha_shape),
    Row("Drake IRIS-NP2", "drake", GROWN, drake_iris_np2),
    Row("Drake IRIS-ZO", "drake", GROWN, drake_iris_zo),
    Row("Drake C-IRIS", "drake", PROVED, drake_ciris),
    Row("Codac", "codac", PAVED, codac_paving),
)
PEERS = (*OURS, *THEIRS)


@dataclass(frozen=True)
class Job:
    """One request, to several peers in turns.

    Attributes
    ----------
    task, scene, label : str
        With the name of the peer's function they are the measurement's id.
    functions : tuple of callable
        The peers.
    request : dict
    quick : dict or None
        What of the request is otherwise in a trial run; None leaves the job out of one.
    rounds : int
        At most so many; the trial run has two.
    """

    task: str
    scene: str
    label: str
    functions: tuple[Callable[..., Timed], ...]
    request: dict[str, Any]
    quick: dict[str, Any] | None = field(default_factory=dict)
    rounds: int = 7

    def id_of(self, function: Callable[..., Timed]) -> str:
        """Return the id of the measurement of one peer."""
        peer = function.__name__.replace("_", "-")
        return "-".join(filter(None, [self.task, self.scene, self.label, peer]))


US = (qbound_numpy, qbound_compiled, qbound_compiled_two)
LIBRARIES = (pinocchio_coal, python_fcl, mujoco_contacts)
IRIS = (drake_iris_np2, drake_iris_zo)
PAVERS, PROVERS = (qbound_cells, codac_paving), (qbound_certificate, drake_ciris)
LONG = {"count": 10_000_000}, {"count": 1_000_000}
SHORT = {"count": 100_000}, {"count": 20_000}
CALLS = {"count": 5000}, {"count": 1000}
PLANAR = ("paper", "walls", "hundred", "obstacles10")
LIGHT = ("walls", "paper")
BOXES = {("paper", 1): 0.042, ("paper", 0.1): 0.0099, ("walls", 1): 0.06, ("walls", 0.1): 0.0061}
"""Sizes of Codac's boxes that leave so many per cent of the joint box undecided."""


def region(scene: str, accuracy: float, functions: Any, rounds: int, quick: bool = False) -> Job:
    """Return the job of finding the boundary of a region to an accuracy, rad."""
    request, trial = {"accuracy": accuracy}, {} if quick else None
    return Job("region", scene, f"{accuracy:.0e}", functions, request, trial, rounds)


JOBS = (
    Job("stream", "paper", "100k", (*US, *LIBRARIES, closed_form_numba, shapely_points), *SHORT),
    Job("stream", "paper", "10m", (*US, pinocchio_coal, closed_form_numba), *LONG),
    Job("stream", "walls", "100k", (*US, *LIBRARIES, closed_form_numba, shapely_points), *SHORT),
    Job("stream", "walls", "10m", (*US, closed_form_numba), *LONG),
    Job("stream", "ur5", "100k", (*US, pinocchio_coal, mujoco_contacts), SHORT[0], {"count": 5000}),
    Job("stream", "ur5", "10k", (qbound_numpy, python_fcl), {"count": 10_000}, {"count": 2000}),
    Job("one", "paper", "", (*US[:2], *LIBRARIES, closed_form_numba), *CALLS),
    Job("one", "walls", "", (*US[:2], *LIBRARIES, closed_form_numba), *CALLS),
    Job("one", "ur5", "", (*US[:2], *LIBRARIES), *CALLS),
    *(
        Job("limit", "machine", f"{kind}-{n}", (limits,), {"kind": kind, "threads": n, **LONG[0]})
        for kind in ("read", "both")
        for n in (1, 2)
    ),
    *(region(s, 1e-3, (qbound_arcs, rays), 7, quick=s in LIGHT) for s in PLANAR),
    *(region(s, 1e-2, (qbound_arcs, rays), 3) for s in PLANAR),
    *(region(s, x, (rays,), 1) for s in LIGHT for x in (1e-4, 1e-6, 1e-8, 1e-10)),
    *(region(s, 1e-1, (alpha_shape,), 3, quick=s in LIGHT) for s in PLANAR),
    *(region(s, x, (alpha_shape,), 1) for s, x in (("paper", 5e-2), ("walls", 3e-2))),
    region("paper", 1e-2, (alpha_shape,), 1),
    *(Job("iris", scene, "1", IRIS, {"count": 1}, {}, 3) for scene in LIGHT),
    *(Job("iris", scene, "10", IRIS, {"count": 10}, None, 1) for scene in LIGHT),
    Job("iris", "obstacles10", "1", IRIS, {"count": 1}, None, 1),
    Job("iris", "hundred", "1", (drake_iris_zo,), {"count": 1}, None, 1),
    *(
        Job("paving", scene, f"{part}", PAVERS, {"undecided": part / 100, "eps": size})
        for (scene, part), size in BOXES.items()
    ),
    *(
        Job("certify", scene, "", PROVERS, {"iterations": 10}, {"iterations": 2}, 3)
        for scene in LIGHT
    ),
    Job("certify", "walls", "50", (drake_ciris,), {"iterations": 50}, None, 1),
    *(Job("alone", scene, "", (qbound_certificate,), {}) for scene in LIGHT),
)
