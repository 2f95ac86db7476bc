"""Drake's C-IRIS: a polytope in t = tan(q / 2), proved free of collisions by sums of squares."""

from __future__ import annotations

import os
from functools import lru_cache
from typing import Any

import numpy as np
from serve import Refused, Timed, serve, timed

FARTHEST = 3.0
"""Largest joint value: t is infinite at half a turn."""

PER_EDGE = 64
"""Points on each edge of a polytope, which is bent in the plane of the joints."""


@lru_cache(maxsize=8)
def prepared(name: str) -> tuple[Any, ...]:
    """Return collision checker, C-IRIS, its kinematics, home as t and the box of t."""
    import scenes
    from drake_scene import checker, diagram
    from pydrake.geometry.optimization import (
        CspaceFreePolytope,
        HPolyhedron,
        SeparatingPlaneOrder,
    )
    from pydrake.multibody.rational import RationalForwardKinematics

    scene = scenes.plain(name)
    if scene["bodies"] or any(joint["type"] == "prismatic" for joint in scene["joints"]):
        raise Refused("balls and turning joints only")
    for joint in scene["joints"]:
        joint["low"], joint["high"] = (
            max(joint["low"], -FARTHEST),
            min(joint["high"], FARTHEST),
        )
    made = diagram(scene)
    plant, zero = made.plant(), np.zeros(len(scene["joints"]))
    # Its documentation recommends affine planes first, as in the paper's examples.
    proof = CspaceFreePolytope(
        plant, made.scene_graph(), SeparatingPlaneOrder.kAffine, zero, CspaceFreePolytope.Options()
    )
    kinematics = RationalForwardKinematics(plant)
    ends = [
        kinematics.ComputeSValue(limits, zero)
        for limits in (plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits())
    ]
    home = kinematics.ComputeSValue(np.array(scene["home"], dtype=float), zero)
    return checker(made), proof, kinematics, home, HPolyhedron.MakeBox(*ends)


def certify(scene: str, iterations: int = 10) -> Timed:
    """Grow a polytope by IRIS-ZO, shrink it till it is proved, then enlarge that by turns.

    ``iterations`` of bilinear alternation; 10 is the documented default. Clarabel, the fastest of
    the solvers that need no licence: SCS and CSDP take ten times as long.
    """
    parts = prepared(scene)
    wall, processor, found = timed(lambda: _certify(*parts, iterations))
    if not found:
        raise Refused("nothing was proved about home")
    last = found[-1].certified_polytope()
    answer = {"rings": [[_ring(last)]], "steps": len(found) - 1, "solver": "Clarabel"}
    return wall, processor, answer


def _certify(
    check: Any, proof: Any, kinematics: Any, home: np.ndarray, domain: Any, iterations: int
) -> list[Any]:
    """Return what was proved, step by step; nothing if it failed."""
    from pydrake.geometry.optimization import CspaceFreePolytope

    start = _grown(check, kinematics, home, domain)
    search = CspaceFreePolytope.BinarySearchOptions()
    search.scale_max = 1.0
    _solver(search.find_lagrangian_options, threads=True)
    first = proof.BinarySearch(set(), start.A(), start.b(), home, search)
    if first is None:
        return []
    options = CspaceFreePolytope.BilinearAlternationOptions()
    options.max_iter = iterations
    _solver(options.find_lagrangian_options, threads=True)
    _solver(options.find_polytope_options)
    options.find_polytope_options.backoff_scale = 0.02
    # A little inside of what was proved: on its border the first program has no room.
    level = first.C() @ home
    inside = level + 0.98 * (first.d() - level)
    return [first, *proof.SearchWithBilinearAlternation(set(), first.C(), inside, options)]


def _grown(check: Any, kinematics: Any, home: np.ndarray, domain: Any) -> Any:
    """Return a polytope in t about home by IRIS-ZO, without redundant faces."""
    from pydrake.common import Parallelism
    from pydrake.geometry.optimization import Hyperellipsoid
    from pydrake.planning import IrisParameterizationFunction, IrisZo, IrisZoOptions

    options = IrisZoOptions()
    options.parameterization = IrisParameterizationFunction(
        kin=kinematics, q_star_val=np.zeros(len(home))
    )
    options.sampled_iris_options.parallelism = Parallelism(1)
    ball = Hyperellipsoid.MakeHypersphere(0.01, home)
    return IrisZo(check, ball, domain, options).ReduceInequalities()


def _solver(options: Any, threads: bool = False) -> None:
    """Take Clarabel, and one thread."""
    from pydrake.common import Parallelism
    from pydrake.solvers import ClarabelSolver

    options.solver_id = ClarabelSolver.id()
    if threads:
        options.parallelism = Parallelism(1)


def _ring(polytope: Any) -> list[list[float]]:
    """Return a polytope's border in joint values, points along each edge."""
    from drake_iris import ring

    corners = np.array(ring(polytope))
    along = np.linspace(0, 1, PER_EDGE, endpoint=False)[:, None, None]
    edges = corners + along * (np.roll(corners, -1, axis=0) - corners)
    return (2 * np.arctan(edges.transpose(1, 0, 2).reshape(-1, 2))).tolist()


if __name__ == "__main__":
    os.environ["DRAKE_NUM_THREADS"] = "1"
    serve("Drake C-IRIS", {"pydrake": "drake"}, {"certify": certify})
