"""The measure of answers about a region, and the methods that are compared by it."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from qbound import find_region
from qbound.boundary.evaluator import evaluator
from qbound.forms.factors import TURN
from support.scripts import importable

SIDE_BY_SIDE = Path(__file__).parents[1] / "benchmarks" / "side_by_side"
with importable(SIDE_BY_SIDE.parent), importable(SIDE_BY_SIDE), importable(SIDE_BY_SIDE / "peers"):
    import alpha_arrays
    import closed_form_joints
    import grid
    import planar
    import planar_plan
    import qbound_joints
    import rays
    import reference
    import refined_grid
    import scenes
    from quality import packed, quality, rings_of, true_region, unpacked
    from serve import Refused

WALLS_AREA = 3.21682
SQUARE = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]
DRAWN = 1e-3


def answered(method, scene, accuracy):
    answer = method.region(scene, accuracy)[2]
    return quality(scene, answer["rings"], answer.get("at"))


@pytest.mark.parametrize(
    "scene", ["paper", "walls", "hundred", "obstacles10", "joints-2", "joints-4"]
)
def test_the_closed_form_has_the_margins_of_qbound(scene):
    q, form = scenes.configurations(scene, 2000, 1), planar.arm(scene)
    theirs, ours = form.of(q.T), evaluator(scenes.robot(scene), limits=False).margins(q).min(axis=1)
    assert np.allclose(np.maximum(theirs, -1e-3), np.maximum(ours, -1e-3), rtol=0, atol=1e-11)


def test_a_grid_has_the_margins_of_its_places():
    form, (x, y) = planar.arm("obstacles10"), np.random.default_rng(2).uniform(-3, 3, (2, 40))
    every = np.stack(np.meshgrid(x, y, indexing="ij")).reshape(2, -1)
    assert np.allclose(form.over_grid(x, y).ravel(), form.of(every), rtol=0, atol=1e-14)


def test_no_margin_is_steeper_than_the_reach():
    q = scenes.configurations("obstacles10", 4000, 3)
    form, step = planar.arm("obstacles10"), np.array([1e-4, -1e-4])
    change = np.abs(form.of((q + step).T) - form.of(q.T))
    assert change.max() <= 1e-4 * sum(form.slopes) * (1 + 1e-6)


@pytest.mark.parametrize("scene", ["paper", "walls"])
def test_the_exact_answer_is_as_good_as_it_is_drawn(scene):
    found = quality(scene, packed(rings_of(find_region(scenes.robot(scene)), DRAWN)))
    assert found["components"] == found["true_components"]
    assert 0.2 * DRAWN < found["distance"] <= DRAWN
    assert found["covered"] == pytest.approx(1, abs=1e-3)
    assert found["beyond"] < 1e-3


def test_the_area_between_the_walls_is_the_known_one():
    assert true_region("walls").area == pytest.approx(WALLS_AREA, abs=5e-6)


def test_a_small_square_is_measured_as_what_it_is():
    found = quality("walls", [[SQUARE]])
    assert found["area"] == pytest.approx(0.04)
    assert found["covered"] == pytest.approx(0.04 / WALLS_AREA, rel=1e-5)
    assert (found["beyond"], found["components"], found["corners"]) == (0, 1, 4)
    assert found["missed"] > found["invented"] > 0.1
    region = true_region("walls").polygons
    corner = region.exterior if hasattr(region, "exterior") else region.geoms[0].exterior
    far = max(math.hypot(*np.maximum(np.abs(q) - 0.1, 0)) for q in corner.coords)
    assert found["missed"] == pytest.approx(far, abs=1e-6)


def test_what_is_claimed_and_not_feasible_is_beyond():
    whole = [[1.57 * x * 10, 1.57 * y * 10] for x, y in SQUARE]
    found = quality("walls", [[whole]])
    assert found["covered"] == pytest.approx(1)
    assert found["beyond"] == pytest.approx((2 * 1.57) ** 2 / WALLS_AREA - 1, rel=1e-6)


def test_nothing_answered_has_no_distance():
    found = quality("walls", [])
    assert (found["area"], found["covered"], found["components"]) == (0, 0, 0)
    assert found["distance"] is None


def test_an_answer_may_be_given_in_other_turns():
    rings = rings_of(find_region(scenes.robot("paper")), DRAWN)
    moved = [[np.array(ring) + TURN * np.array([1, -1]) for ring in part] for part in rings]
    ours, theirs = quality("paper", rings), quality("paper", moved)
    for name, value in ours.items():
        assert theirs[name] == pytest.approx(value, rel=1e-6, abs=1e-9), name


def test_packed_rings_are_the_rings():
    rings = [[SQUARE, SQUARE[::-1]], [[[0, 1], [2, 3.5], [1, 1e-9]]]]
    for part, same in zip(rings, unpacked(packed(rings)), strict=True):
        for ring, again in zip(part, same, strict=True):
            assert again.tolist() == ring


@pytest.mark.parametrize(
    ("method", "scene", "within", "components"),
    [
        (grid, "walls", 1e-2, 1),
        (grid, "paper", 4e-2, 5),
        (refined_grid, "walls", 1e-2, 1),
        (refined_grid, "paper", 4e-2, 5),
        (rays, "walls", 0.1, 1),
    ],
)
def test_methods_come_as_near_as_they_can(method, scene, within, components):
    pytest.importorskip("contourpy")
    found = answered(method, scene, 1e-2)
    assert found["components"] == components
    assert 0 < found["distance"] <= within
    assert found["area_error"] < 1e-2


def test_long_strides_step_over_thin_obstacles():
    start = planar.start("paper")
    long, short = (rays.region("paper", 1e-2, stride)[2]["rings"] for stride in (0.05, 0.005))
    assert quality("paper", long, start)["beyond"] > 0.5
    assert quality("paper", short, start)["beyond"] < 1e-3


def test_an_alpha_shape_joins_what_thin_obstacles_part():
    pytest.importorskip("scipy")
    found = answered(alpha_arrays, "paper", 0.1)
    assert found["components"] < found["true_components"]
    assert found["covered"] > 0.9


@pytest.mark.parametrize("method", [grid, rays, alpha_arrays])
def test_what_would_take_too_long_is_refused(method):
    with pytest.raises(Refused, match="more than"):
        method.region("walls", 1e-12)


def test_vertices_are_held_against_more_digits():
    found = reference.errors("walls")
    assert (found["vertices"], found["digits"]) == (4, 60)
    assert 0 < max(found["vertex_error"], found["arc_error"]) < 1e-14
    assert found["area_error"] < 1e-12


def test_a_place_beside_a_body_is_told_to_be_beside_it():
    arc = find_region(scenes.robot("obstacles10")).components[0].loops[0][0]
    (q, after), form = arc.at([0.4, 0.40001]), planar.arm("obstacles10")
    across = np.array([-1, 1]) * (after - q)[::-1] / math.hypot(*(after - q))
    assert reference.by_margin(form, q[None]) < 1e-12
    assert reference.by_margin(form, (q + 1e-6 * across)[None]) == pytest.approx(1e-6, rel=1e-2)


def test_a_place_beside_a_vertex_is_told_to_be_beside_it():
    arm = scenes.robot("walls")
    vertex, functions = find_region(arm).components[0].vertices[0], reference.functions_of(arm)
    both = [functions[name] for name in vertex.boundaries]
    beside = vertex.q + 1e-9 * np.array([0.6, 0.8])
    assert reference.distance(beside, both) == pytest.approx(1e-9, rel=1e-4)


@pytest.mark.parametrize("joints", [2, 3])
def test_fibres_and_a_grid_find_the_same_feasible_part(joints):
    ours, theirs = (
        partial(method.part, f"joints-{joints}", 0.1)()[2]["part"]
        for method in (qbound_joints, closed_form_joints)
    )
    assert 0.2 < ours < 0.5
    assert theirs == pytest.approx(ours, abs=0.01)


def test_each_measurement_has_an_id_of_its_own():
    names = [job.id_of(peer) for job in planar_plan.JOBS for peer in job.peers]
    assert len(set(names)) == len(names)
    programs = {peer for job in planar_plan.JOBS for peer in job.peers}
    assert all((SIDE_BY_SIDE / "peers" / f"{name}.py").exists() for name in programs)
