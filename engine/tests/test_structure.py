# ruff: noqa: E501  (rows of robot files, one a line)
"""Proved components of regions with bodies: scenes, proposals that are wrong, and what touches."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from cspace import find_region, load_robot
from cspace.proofs import Unproved
from cspace.proofs.exact.components import Structure, prove_structure
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.proofs.exact.region import prove_region
from cspace.proofs.exact.stars import Stars, Undecided
from cspace.region import Problem, Region, solve
from engine_support.arms_in_planes import scene
from engine_support.exact import stated
from engine_support.forms import EDGES, LIMITS
from engine_support.robots import random_robot
from engine_support.scenes import random_scene


def loops(region: Region) -> list[tuple[int, tuple[bool, bool]]]:
    return [(len(c.loops), c.wraps) for c in region.components]


@pytest.mark.parametrize("obstacles", [1, 3, 10])
@pytest.mark.parametrize("kinds", ["RR", "RP", "PR", "PP"])
def test_components_amid_obstacles_are_proved(tmp_path, kinds, obstacles):
    """Convex links; obstacles of all shapes, some of them hooks. Every plane has its turn."""
    seed = {"RR": 4, "RP": 6, "PR": 7, "PP": 7}[kinds]
    file = tmp_path / "scene.toml"
    file.write_text(scene(seed, kinds, "xyz"[seed % 3], obstacles), encoding="utf-8")
    region = find_region(load_robot(file))
    proved = prove_structure(exact_problem(exact_robot(file)), region)
    assert [(part.loops, part.wraps) for part in proved] == loops(region)


@pytest.mark.parametrize("seed", [12, 18, 46, 53])
def test_random_scenes_are_proved_as_the_float_engine_finds_them(seed):
    """In 46 and 53 bodies are cut, and no distance is kept."""
    robot = random_scene(seed)
    region = find_region(robot)
    proved = prove_structure(exact_problem(exact_robot(robot)), region)
    assert [(part.loops, part.wraps) for part in proved] == loops(region)
    assert all(region.components_of(part.place) == (k,) for k, part in enumerate(proved))


@pytest.mark.parametrize("robot", [load_robot("minervabot-v2"), *map(random_robot, range(4, 10))])
def test_a_configuration_lies_in_the_component_that_the_float_engine_says(robot):
    structure, region = Structure(exact_problem(exact_robot(robot))), find_region(robot)
    ends = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints])
    tried = np.random.default_rng(4).uniform(*ends.T, size=(40, 2))
    pairs = {(structure.part_of(q), region.component_of(q)) for q in tried}
    assert all((part < 0) == (owner is None) for part, owner in pairs)
    assert len({part for part, _ in pairs}) == len({owner for _, owner in pairs}) == len(pairs)


def test_on_the_boundary_nothing_is_said():
    vertex = find_region(load_robot("minervabot-v2")).components[1].vertices[0].q
    assert Structure(exact_problem(exact_robot("minervabot-v2"))).part_of(vertex) == -1


@pytest.mark.parametrize("seed", [3, 46, 53])
def test_every_cell_is_what_it_is_said_to_be(seed):
    """From free places of a star the straight way to its middle stays free."""
    robot, rng = random_scene(seed), np.random.default_rng(0)
    stars, margins = Structure(exact_problem(exact_robot(robot))).stars, find_region(robot).margins
    cells = stars.plane()
    low, high = stars.places(cells.low)[:, None], stars.places(cells.high)[:, None]
    q = rng.uniform(low, high, (len(cells), 25, 2))
    free = margins(q).min(axis=-1) > 1e-9
    assert not free[cells.blocked].any()
    assert free[~cells.blocked & ~cells.star].all()
    for t in np.linspace(0, 1, 7):
        way = (1 - t) * q + t * cells.middle[:, None]
        assert (margins(way).min(axis=-1) > -1e-9)[cells.star[:, None] & free].all()


ROUND_POST = stated(
    ("prismatic", "prismatic"), [{"00": -1, "20": 1, "02": 1}], ((-2.0, 2.0), (-2.0, 2.0))
)
"""What is free lies outside a disc of radius 1."""


def test_a_contact_grows_only_if_it_exceeds_what_it_bends():
    """From (1.9, 1.9) not all that is outside the disc is seen; within a small cell it is."""
    stars, one = Stars(ROUND_POST), np.zeros(1, dtype=np.int64)
    for place, middle, half, grows in ((1.9, 0.0, 2.0, False), (0.75, 0.71, 0.05, True)):
        points = [np.full((1, 2), x) for x in (place, half, middle)]
        assert stars.grows(*points, one, one).tolist() == [grows]


def test_no_cell_is_a_star_unless_its_contacts_grow(monkeypatch):
    assert Stars(ROUND_POST).plane().star.any()
    monkeypatch.setattr(Stars, "grows", lambda self, *cells: np.zeros(len(cells[-1]), dtype=bool))
    with pytest.raises(Undecided, match="f0: not decided near"):
        Stars(ROUND_POST).plane()


PROVABLE = sorted(
    EDGES.keys()
    - {
        "identically zero", "1 - cos q1", "1 - cos q2", "cos q1 - 1", "cos q1 + cos q2 - 2",
        "cos q1 cos q2", "cos q1 + cos q2", "cos q1 - cos q2", "two lobes at a saddle",
        "saddle, the other way", "x^2", "-x^2", "(x - y)^2", "1 - cos(q1 - q2)", "tangent discs",
        "disc between limits", "a form and its negative", "a range of no width", "opposite lines",
    }
)  # fmt: skip
"""Rows of the edge table without places where the region is torn; forms may well coincide."""


@pytest.mark.parametrize("name", PROVABLE)
def test_forms_that_coincide_do_no_harm(name):
    kinds, ranges, terms, expected = EDGES[name]
    exact = stated(kinds, terms, ranges)
    floats = exact.forms.coefficients.astype(float)
    region = solve(
        Problem(type(exact.forms)(floats, kinds), exact.names, ranges, LIMITS), np.array([0.1, 0.2])
    )
    proved = prove_structure(exact, region)
    assert [(part.loops, part.wraps) for part in proved] == loops(region)
    assert len(proved) == len(expected)


@pytest.mark.parametrize("name", ["x^2", "two lobes at a saddle"])
def test_a_region_that_is_torn_along_a_curve_or_in_a_point_is_refused(name):
    kinds, ranges, terms, _ = EDGES[name]
    with pytest.raises(Unproved, match="not decided near"):
        Structure(stated(kinds, terms, ranges))


# --- bodies that nearly touch ---------------------------------------------------------------------

GATE = """
schema = 1
name = "gate"
length_unit = "m"
angle_unit = "deg"
home = {{ x = 1, y = 1 }}
tool = "tip"
collisions = "all"
joint = [
  {{ name = "x", type = "prismatic", parent = "base", frame = "cart", axis = [1, 0, 0], origin = [0, 0, 0], limits = [0.6, 3.4] }},
  {{ name = "y", type = "prismatic", parent = "cart", frame = "hand", axis = [0, 0, 1], origin = [0, 0, 0], limits = [0.6, 3.4] }},
]
point = [
  {{ name = "tip", frame = "hand", at = [0, 0, 0] }},
]
body = [
  {{ frame = "hand", name = "disc", disc = {{ at = [0, 0], radius = 0.5 }} }},
]
obstacle = [
  {{ polygon = [[1.9, -1], [2.1, -1], [2.1, 1.3], [1.9, 1.3]] }},
  {{ polygon = [[1.9, {top}], [2.1, {top}], [2.1, 5], [1.9, 5]] }},
]
"""
"""A disc on two slides, and a gate in a wall, as wide as the disc where `top` is 2.3."""


def gate(tmp_path: Path, top: str) -> Path:
    file = tmp_path / "gate.toml"
    file.write_text(GATE.format(top=top), encoding="utf-8")
    return file


@pytest.mark.parametrize(("top", "count"), [("2.30000001", 1), ("2.29999999", 2)])
def test_ten_nanometres_decide_whether_a_gate_is_passed(tmp_path, top, count):
    assert len(Structure(exact_problem(exact_robot(gate(tmp_path, top)))).parts()) == count


def test_a_gate_as_wide_as_the_disc_is_refused(tmp_path):
    file = gate(tmp_path, "2.3")
    with pytest.raises(Unproved, match="bodies touch there, or a gap has no width"):
        prove_region(exact_problem(exact_robot(file)), find_region(load_robot(file)))


SLIT = """
schema = 1
name = "slit"
length_unit = "m"
angle_unit = "deg"
home = { q1 = 134.064, q2 = 68.255 }
tool = "tip"
collisions = "all"
allowed = [["upper", "fore"], ["bulge", "fore"]]
joint = [
  { name = "q1", type = "revolute", parent = "base", frame = "L1", origin = [0.031, 0.0, -0.085], axis = [0.0, -1.0, 0.0] },
  { name = "q2", type = "revolute", parent = "L1", frame = "L2", origin = [0.751, 0.0, 0.0], axis = [0.0, 1.0, 0.0] },
]
point = [
  { name = "tip", frame = "L2", at = [0.639, 0.0, 0.0] },
]
body = [
  { name = "upper", frame = "L1", polygon = [[-0.066, -0.037], [0.751, -0.037], [0.751, 0.234], [0.696, 0.234], [0.696, 0.037], [-0.066, 0.037]] },
  { name = "bulge", frame = "L1", polygon = [[0.287, 0.028], [0.224, 0.062], [0.186, 0.236], [0.244, 0.302], [0.473, 0.19]] },
  { name = "fore", frame = "L2", polygon = [[-0.032, -0.031], [0.639, -0.022], [0.639, 0.022], [-0.032, 0.031]] },
]
obstacle = [
  { disc = { at = [0.733, 0.292], radius = 0.03 } },
]
"""
"""Two components; in floats one critical value may come out twice, and specks between the two."""


def test_a_scene_in_which_floats_saw_specks_has_two_components(tmp_path):
    file = tmp_path / "slit.toml"
    file.write_text(SLIT, encoding="utf-8")
    exact = exact_problem(exact_robot(file))
    found = {(part.loops, part.wraps) for part in Structure(exact).parts()}
    assert found == {(2, (False, True)), (1, (False, False))}
    region = find_region(load_robot(file))
    speck = replace(region.components[0], area=4e-10, contains_home=False)
    with pytest.raises(Unproved, match="components are proposed, 2 are proved"):
        prove_structure(exact, replace(region, outlined=(*region.components, speck, speck)))


# --- proposals that are wrong in one thing --------------------------------------------------------


@dataclass(frozen=True)
class Proposed:
    """As much of an arc as a proof reads."""

    boundary: str
    points: np.ndarray


@pytest.fixture(scope="module")
def proposed(tmp_path_factory):
    """A region of two components, of three loops and of one, and its exact problem."""
    file = tmp_path_factory.mktemp("scene") / "scene.toml"
    file.write_text(scene(1, "PR", "y", 3), encoding="utf-8")
    region = find_region(load_robot(file))
    assert [len(c.loops) for c in region.components] == [3, 1]
    return exact_problem(exact_robot(file)), region


def backwards(loop):
    return tuple(Proposed(arc.boundary, arc.points[::-1]) for arc in loop[::-1])


def moved(loop, by):
    return tuple(Proposed(arc.boundary, arc.points + by) for arc in loop)


FAULTS = {
    "a component is missing": (lambda one, other: (one,), "1 components are proposed, 2 are"),
    "nothing is proposed": (lambda one, other: (), "0 components are proposed"),
    "a component comes twice": (lambda one, other: (one, one), "two proposed components"),
    "two are merged": (lambda one, other: (replace(one, loops=one.loops + other.loops),), "1 components are proposed"),
    "two are merged, and a third is made up": (lambda one, other: (replace(one, loops=one.loops + other.loops), other), "more than one"),
    "a loop is missing": (lambda one, other: (replace(one, loops=one.loops[1:]), other), "2 loops are proposed, 3 are proved"),
    "a loop comes twice, and another is missing": (
        lambda one, other: (replace(one, loops=(one.loops[0], one.loops[0], one.loops[1])), other),
        "a piece of boundary at .* is not proposed",
    ),
    "an arc is missing": (lambda one, other: (one, replace(other, loops=(other.loops[0][1:],))), "no arc goes on"),
    "a loop is split": (lambda one, other: (one, replace(other, loops=(other.loops[0][:2], other.loops[0][2:]))), "no arc goes on"),
    "a loop runs backwards": (lambda one, other: (one, replace(other, loops=(backwards(other.loops[0]),))), "no boundary at"),
    "a loop lies a micrometre beside": (lambda one, other: (one, replace(other, loops=(moved(other.loops[0], 1e-6),))), "no boundary at"),
    "it goes round a joint that it does not go round": (lambda one, other: (one, replace(other, wraps=(False, True))), "does not go round"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_proposal_that_is_wrong_in_one_thing_is_not_proved(proposed, name):
    exact, region = proposed
    change, message = FAULTS[name]
    with pytest.raises(Unproved, match=message):
        prove_structure(exact, replace(region, outlined=change(*region.components)))


def test_a_proved_region_with_bodies_has_components_without_areas(proposed):
    proved = prove_region(*proposed)
    assert [c.area for c in proved.components] == [None, None]
    with pytest.raises(ValueError, match="its area is not proved"):
        _ = proved.area
