"""Drake: convex polytopes of joint space, sampled (IRIS-NP2, IRIS-ZO) or proved (C-IRIS).

Everything runs on one thread. Options are the documented defaults but where a comment says why.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import islice
from typing import Any

import numpy as np
import scenes
from asking import Timed, timed

from cspace import Robot
from cspace.model.robot import Body, BodyPair, Capsule, Disc

WIDE = 1e3
"""Half the width of the box that stands for a half-space, in the scene's unit: C-IRIS knows no
half-spaces, and the fifteenth ends the process."""
THICK = 1.0
"""Half the width of the prism on an outline, across the plane of motion."""
FARTHEST = 3.0
"""Largest joint value of C-IRIS, whose t = tan(q / 2) is infinite at half a turn."""
PER_EDGE = 64
"""Points on each edge of a polytope in t, which is bent in the plane of the joints."""


# --- a scene --------------------------------------------------------------------------------------


class Model:
    """A multibody plant in which nothing but the scene's own pairs collides.

    Each shape is welded on as a body of its own, because Drake's checker filters whole bodies.
    """

    def __init__(self, arm: Robot, most: float = np.inf) -> None:
        from pydrake.math import RigidTransform, RotationMatrix
        from pydrake.multibody.tree import FixedOffsetFrame, RevoluteJoint
        from pydrake.planning import RobotDiagramBuilder

        builder = RobotDiagramBuilder(time_step=0.0)
        self.arm, self.plant = arm, builder.plant()
        self.instance, self.shapes = self.plant.AddModelInstance("arm"), list[Any]()
        self.frames = {arm.base: self.plant.world_body()}
        for joint, low, high in zip(arm.joints, *scenes.ends(arm), strict=True):
            parent, body = self.frames[joint.parent], self.body(joint.frame)
            mount = RigidTransform(RotationMatrix(np.asarray(joint.mount, float)), joint.origin)
            place = FixedOffsetFrame(f"at {joint.name}", parent.body_frame(), mount, self.instance)
            at = self.plant.AddFrame(place)
            made = RevoluteJoint(joint.name, at, body.body_frame(), np.asarray(joint.axis, float))
            self.plant.AddJoint(made).set_position_limits([max(low, -most)], [min(high, most)])
            self.frames[joint.frame] = body
        pairs = self.collisions()
        self.plant.Finalize()
        self.diagram = builder.Build()
        self.filter(pairs)

    def body(self, name: str) -> Any:
        """Add a body; nothing is simulated, so any mass will do."""
        from pydrake.multibody.tree import SpatialInertia, UnitInertia

        mass = SpatialInertia(1.0, np.zeros(3), UnitInertia(1.0, 1.0, 1.0))
        return self.plant.AddRigidBody(name, self.instance, mass)

    def add(self, frame: str, shape: Any, place: Any) -> Any:
        """Weld a shape onto a frame."""
        from pydrake.math import RigidTransform
        from pydrake.multibody.plant import CoulombFriction

        name, friction = f"shape {len(self.shapes)}", CoulombFriction(0.5, 0.5)
        body = self.body(name)
        self.plant.WeldFrames(self.frames[frame].body_frame(), body.body_frame(), place)
        made = self.plant.RegisterCollisionGeometry(body, RigidTransform(), shape, name, friction)
        self.shapes.append(made)
        return made

    def collisions(self) -> list[tuple[Any, Any]]:
        """Add all shapes; return which two may not touch."""
        from pydrake.geometry import Box, Sphere
        from pydrake.math import RigidTransform, RotationMatrix

        arm, told = self.arm, scenes.balls(self.arm)
        balls = {
            name: self.add(arm.point(name).frame, Sphere(r), RigidTransform(arm.point(name).at))
            for name, r in told.radii.items()
        }
        pairs = [(balls[one], balls[other]) for one, other in told.pairs]
        for name, normal, level in told.walls:
            middle = normal * (level - WIDE)
            place = RigidTransform(RotationMatrix.MakeFromOneVector(normal, 2), middle)
            pairs.append((balls[name], self.add(arm.base, Box(*[2 * WIDE] * 3), place)))
        solids = {s.name: self.add(s.frame, *placed(s)) for s in (*arm.bodies, *arm.obstacles)}
        meet = [b.bodies for b in arm.used if isinstance(b, BodyPair)]
        return [*pairs, *((solids[one], solids[other]) for one, other in meet)]

    def filter(self, pairs: list[tuple[Any, Any]]) -> None:
        """Let nothing collide but the pairs."""
        from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

        manager = self.diagram.mutable_scene_graph().collision_filter_manager()
        manager.Apply(CollisionFilterDeclaration().ExcludeWithin(GeometrySet(self.shapes)))
        for pair in pairs:
            one, other = (GeometrySet([shape]) for shape in pair)
            manager.Apply(CollisionFilterDeclaration().AllowBetween(one, other))

    def checker(self) -> Any:
        """Return Drake's collision checker."""
        from pydrake.planning import SceneGraphCollisionChecker

        arms = [self.instance]
        return SceneGraphCollisionChecker(
            model=self.diagram, robot_model_instances=arms, edge_step_size=0.1
        )


def placed(solid: Body) -> tuple[Any, Any]:
    """Return shape and place of a capsule, a disc (as a ball) or a polygon (as a prism)."""
    from pydrake.geometry import Capsule as Rod
    from pydrake.geometry import Convex, Sphere
    from pydrake.math import RigidTransform, RotationMatrix

    shape = solid.shape
    if isinstance(shape, Disc):
        return Sphere(shape.radius), RigidTransform(shape.at)
    if isinstance(shape, Capsule):
        along = shape.end - shape.start
        place = RigidTransform(RotationMatrix.MakeFromOneVector(along, 2), shape.start + along / 2)
        return Rod(shape.radius, float(np.linalg.norm(along))), place
    corners = np.asarray(shape.corners, dtype=float)
    across = np.linalg.svd(corners - corners.mean(axis=0))[2][2] * THICK
    prism = np.concatenate([corners + across, corners - across]).T
    return Convex(prism, solid.name), RigidTransform()


# --- IRIS -----------------------------------------------------------------------------------------


@lru_cache(maxsize=8)
def checked(scene: str) -> tuple[Any, Any]:
    """Return the collision checker and the box of joint limits of a scene."""
    from pydrake.geometry.optimization import HPolyhedron

    arm = scenes.robot(scene)
    return Model(arm).checker(), HPolyhedron.MakeBox(*scenes.ends(arm))


def grown(scene: str, count: int, options: Any, grow: Any) -> Timed:
    """Grow a polytope about home, then about random places that Drake's own checker finds free."""
    import shapely
    from pydrake.common import Parallelism
    from pydrake.geometry.optimization import Hyperellipsoid

    check, domain = checked(scene)
    options.sampled_iris_options.relax_margin = True
    options.sampled_iris_options.parallelism = Parallelism(1)
    some = (scenes.robot(scene).home, *scenes.configurations(scene, 1000))
    places = list(islice(filter(check.CheckConfigCollisionFree, some), count))
    # From a ball of radius 0.01, as in Drake's own examples.
    balls = [Hyperellipsoid.MakeHypersphere(0.01, place) for place in places]
    seconds, processor, found = timed(
        lambda: [grow(check, ball, domain, options) for ball in balls]
    )
    shape = shapely.union_all([shapely.Polygon(corners(each)) for each in found])
    faces = sum(len(each.b()) for each in found)
    return seconds, processor, {"shape": shape, "polytopes": len(found), "faces": faces}


def drake_iris_np2(task: str, scene: str, count: int) -> Timed:
    """Grow by sampled collisions and nonlinear programs.

    IPOPT, since Drake's own example of IRIS-NP2 in Python has found it faster than SNOPT:
    bindings/pydrake/planning/test/iris_test.py.
    """
    from pydrake.planning import IrisNp2, IrisNp2Options
    from pydrake.solvers import IpoptSolver

    options = IrisNp2Options()
    options.solver = IpoptSolver()
    return grown(scene, count, options, IrisNp2)


def drake_iris_zo(task: str, scene: str, count: int) -> Timed:
    """Grow by sampled collisions and bisection."""
    from pydrake.planning import IrisZo, IrisZoOptions

    return grown(scene, count, IrisZoOptions(), IrisZo)


def corners(polytope: Any) -> np.ndarray:
    """Return the corners of a polytope of two joints, anticlockwise, shape (n, 2)."""
    from pydrake.geometry.optimization import VPolytope

    found = VPolytope(polytope.ReduceInequalities()).vertices().T
    off = found - found.mean(axis=0)
    return found[np.argsort(np.arctan2(off[:, 1], off[:, 0]))]


# --- C-IRIS ---------------------------------------------------------------------------------------


def drake_ciris(task: str, scene: str, iterations: int) -> Timed:
    """Grow a polytope in t by IRIS-ZO, shrink it till it is proved, then enlarge that by turns.

    ``iterations`` of bilinear alternation; 10 is the documented default. Affine planes first, as
    its documentation recommends. Clarabel, the fastest of the solvers that need no licence: SCS and
    CSDP take ten times as long.
    """
    import shapely
    from pydrake.common import Parallelism
    from pydrake.geometry.optimization import (
        CspaceFreePolytope,
        HPolyhedron,
        Hyperellipsoid,
        SeparatingPlaneOrder,
    )
    from pydrake.multibody.rational import RationalForwardKinematics
    from pydrake.planning import IrisParameterizationFunction, IrisZo, IrisZoOptions
    from pydrake.solvers import ClarabelSolver

    arm = scenes.robot(scene)
    if arm.collisions:
        raise ValueError("balls alone")
    made = Model(arm, FARTHEST)
    plant, zero, check = made.plant, np.zeros(len(arm.joints)), made.checker()
    affine = SeparatingPlaneOrder.kAffine
    graph = made.diagram.scene_graph()
    proof = CspaceFreePolytope(plant, graph, affine, zero, CspaceFreePolytope.Options())
    kinematics = RationalForwardKinematics(plant)
    limits = (plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits(), arm.home)
    low, high, home = (kinematics.ComputeSValue(q, zero) for q in limits)

    growing = IrisZoOptions()
    growing.parameterization = IrisParameterizationFunction(kin=kinematics, q_star_val=zero)
    growing.sampled_iris_options.parallelism = Parallelism(1)
    search = CspaceFreePolytope.BinarySearchOptions()
    search.scale_max = 1.0
    options = CspaceFreePolytope.BilinearAlternationOptions()
    options.max_iter = iterations
    options.find_polytope_options.backoff_scale = 0.02
    options.find_polytope_options.solver_id = ClarabelSolver.id()
    for each in (search.find_lagrangian_options, options.find_lagrangian_options):
        each.solver_id, each.parallelism = ClarabelSolver.id(), Parallelism(1)

    def work() -> list[Any]:
        ball, box = Hyperellipsoid.MakeHypersphere(0.01, home), HPolyhedron.MakeBox(low, high)
        grown = IrisZo(check, ball, box, growing).ReduceInequalities()
        first = proof.BinarySearch(set(), grown.A(), grown.b(), home, search)
        if first is None:
            raise ValueError("nothing was proved about home")
        # A little inside of what was proved: on its border the first program has no room.
        level = first.C() @ home
        inside = level + 0.98 * (first.d() - level)
        more = proof.SearchWithBilinearAlternation(set(), first.C(), inside, options)
        return [first, *more]

    seconds, processor, found = timed(work)
    ring, along = corners(found[-1].certified_polytope()), np.linspace(0, 1, PER_EDGE, False)
    edges = ring[:, None] + along[:, None] * (np.roll(ring, -1, axis=0) - ring)[:, None]
    shape = shapely.Polygon(2 * np.arctan(edges.reshape(-1, 2)))
    answer = {"shape": shape, "at": arm.home.tolist(), "steps": len(found) - 1}
    return seconds, processor, answer | {"solver": "Clarabel"}
