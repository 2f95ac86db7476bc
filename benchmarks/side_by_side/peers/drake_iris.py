"""Drake's IRIS: convex polytopes of joint space in which, they say, nothing collides."""

from __future__ import annotations

import os
from functools import lru_cache
from itertools import islice
from typing import Any

import numpy as np
from serve import Timed, serve, timed

SEEDS = 15
"""Of the random seeds' generator."""


@lru_cache(maxsize=8)
def prepared(name: str) -> tuple[Any, Any]:
    """Return the collision checker and the box of joint limits of a scene."""
    import scenes
    from drake_scene import checker, diagram
    from pydrake.geometry.optimization import HPolyhedron

    scene = scenes.plain(name)
    low, high = (np.array([joint[end] for joint in scene["joints"]]) for end in ("low", "high"))
    return checker(diagram(scene)), HPolyhedron.MakeBox(low, high)


def seeds(name: str, count: int) -> list[np.ndarray]:
    """Return home, then random configurations: those that Drake's own checker finds free."""
    import scenes

    check, _ = prepared(name)
    home = np.array(scenes.plain(name)["home"], dtype=float)
    some = (home, *scenes.configurations(name, 1000, SEEDS))
    return list(islice(filter(check.CheckConfigCollisionFree, some), count))


def iris(scene: str, variant: str, count: int = 1) -> Timed:
    """Grow a polytope about each of so many seeds, by "np", "np2" or "zo"."""
    check, domain = prepared(scene)
    places = seeds(scene, count)
    grow = {"np": iris_np, "np2": iris_np2, "zo": iris_zo}[variant]
    wall, processor, found = timed(lambda: [grow(check, domain, place) for place in places])
    return wall, processor, answer(found)


def iris_np(check: Any, domain: Any, place: np.ndarray) -> Any:
    """Grow by nonlinear programs; options as they come."""
    from pydrake.geometry.optimization import IrisNp, IrisOptions

    plant, context = check.plant(), check.UpdatePositions(place)
    options = IrisOptions()
    options.bounding_region = domain
    return IrisNp(plant=plant, context=context, options=options)


def iris_np2(check: Any, domain: Any, place: np.ndarray) -> Any:
    """Grow by sampled collisions and nonlinear programs.

    IPOPT, since Drake's own example of IRIS-NP2 in Python has found it faster than SNOPT:
    bindings/pydrake/planning/test/iris_test.py.
    """
    from pydrake.planning import IrisNp2, IrisNp2Options
    from pydrake.solvers import IpoptSolver

    options = IrisNp2Options()
    options.solver = IpoptSolver()
    options.sampled_iris_options.relax_margin = True
    options.sampled_iris_options.parallelism = one_thread()
    return IrisNp2(check, small_ball(place), domain, options)


def iris_zo(check: Any, domain: Any, place: np.ndarray) -> Any:
    """Grow by sampled collisions and bisection."""
    from pydrake.planning import IrisZo, IrisZoOptions

    options = IrisZoOptions()
    options.sampled_iris_options.relax_margin = True
    options.sampled_iris_options.parallelism = one_thread()
    return IrisZo(check, small_ball(place), domain, options)


def cover(scene: str, coverage: float = 0.7) -> Timed:
    """Cover the free space by polytopes from cliques of points that see each other.

    Each polytope by IRIS-ZO, the faster one, in one iteration, as the documentation of
    ``IrisFromCliqueCoverOptions.iris_options`` recommends.
    """
    from pydrake.common import RandomGenerator
    from pydrake.planning import (
        IrisFromCliqueCoverOptions,
        IrisInConfigurationSpaceFromCliqueCover,
        IrisZoOptions,
    )

    check, _ = prepared(scene)
    inner = IrisZoOptions()
    inner.sampled_iris_options.max_iterations = 1
    inner.sampled_iris_options.relax_margin = True
    inner.sampled_iris_options.parallelism = one_thread()
    options = IrisFromCliqueCoverOptions()
    options.iris_options = inner
    options.coverage_termination_threshold = coverage
    options.parallelism = one_thread()
    wall, processor, found = timed(
        lambda: IrisInConfigurationSpaceFromCliqueCover(check, options, RandomGenerator(1), [])
    )
    return wall, processor, answer(found)


def small_ball(place: np.ndarray) -> Any:
    """Return the ellipsoid to start from: as in Drake's own examples, of radius 0.01."""
    from pydrake.geometry.optimization import Hyperellipsoid

    return Hyperellipsoid.MakeHypersphere(0.01, place)


def one_thread() -> Any:
    """Return Drake's word for one thread."""
    from pydrake.common import Parallelism

    return Parallelism(1)


def answer(sets: list[Any]) -> dict[str, Any]:
    """Return polygons, each a component of its own, and the number of their faces."""
    return {
        "rings": [[ring(found)] for found in sets],
        "polytopes": len(sets),
        "faces": int(sum(len(found.b()) for found in sets)),
    }


def ring(found: Any) -> list[list[float]]:
    """Return the corners of a polygon of two joints, anticlockwise."""
    from pydrake.geometry.optimization import VPolytope

    corners = VPolytope(found.ReduceInequalities()).vertices().T
    off = corners - corners.mean(axis=0)
    return corners[np.argsort(np.arctan2(off[:, 1], off[:, 0]))].tolist()


if __name__ == "__main__":
    os.environ["DRAKE_NUM_THREADS"] = "1"
    serve("Drake IRIS", {"pydrake": "drake"}, {"iris": iris, "cover": cover})
