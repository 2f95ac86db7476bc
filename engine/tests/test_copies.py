"""Regions are copied and sent to other processes, and no cache gives one the numbers of another."""

import copy
import multiprocessing
import pickle

import pytest

from cspace import find_region, load_robot
from cspace.model.robotfile import parse_robot
from cspace.region import clearance_problem
from cspace.region.region import faults
from cspace.region.scene import scene_of

TWO = [
    "minervabot-v2",
    "minervabot-v2-bodies",
    "two-links-on-a-table",
    "two-joint-arm-with-walls",
    "pp-portal",
    "rp-telescopic-boom",
]


def slot(half: str) -> str:
    """A square of half-width 0.2 that slides in a plane, and a slot in a wall."""
    return f"""schema = 1
name = "a square and a slot"
length_unit = "m"
angle_unit = "deg"
home = {{ x = -1, y = 0 }}
tool = "tip"
collisions = "all"
point = [{{ name = "tip", frame = "box", at = [0, 0, 0] }}]
body = [{{ frame = "box", polygon = [[-0.2, -0.2], [0.2, -0.2], [0.2, 0.2], [-0.2, 0.2]] }}]
obstacle = [
  {{ name = "above", polygon = [[-0.05, {half}], [0.05, {half}], [0.05, 3], [-0.05, 3]] }},
  {{ name = "below", polygon = [[-0.05, -3], [0.05, -3], [0.05, -{half}], [-0.05, -{half}]] }},
]
[[joint]]
name = "x"
type = "prismatic"
parent = "base"
frame = "beam"
origin = [0, 0, 0]
axis = [1, 0, 0]
limits = [-2, 2]
[[joint]]
name = "y"
type = "prismatic"
parent = "beam"
frame = "box"
origin = [0, 0, 0]
axis = [0, 1, 0]
limits = [-2, 2]
"""


SHUT, OPEN = "0.2", "0.2000000000000000001"
"""One double; the slot of the second is wider than the square by 2e-19."""


def found(name: str):
    return find_region(load_robot(name))


# --- copies ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", TWO)
@pytest.mark.parametrize(
    "copied", [lambda region: pickle.loads(pickle.dumps(region)), copy.deepcopy, copy.copy]
)
def test_a_copy_of_a_region_answers_as_the_region(name, copied):
    region = found(name)
    again = copied(region)
    assert again == region
    assert again.to_dict() == region.to_dict()
    assert faults(again) == []  # exact numbers are made again when they are needed
    q = region.sample(50, seed=1)
    assert again.component_of(q).tolist() == region.component_of(q).tolist()
    assert copied(again) == region


def test_a_region_of_bodies_comes_back_from_a_process_pool():
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        (again,) = pool.map(found, ["two-links-on-a-table"])
    assert again == found("two-links-on-a-table")


@pytest.mark.parametrize(("half", "components"), [(SHUT, 2), (OPEN, 1)])
def test_a_copy_keeps_the_decimals_of_its_file(half, components):
    region = find_region(parse_robot(slot(half)))
    again = pickle.loads(pickle.dumps(region))
    assert len(again.components) == len(find_region(again.robot).components) == components


# --- caches ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("halves", [(SHUT, OPEN), (OPEN, SHUT), (SHUT, OPEN, SHUT)])
def test_two_files_that_are_equal_in_doubles_have_their_own_regions(halves):
    robots = [parse_robot(slot(half)) for half in halves]
    assert len(set(robots)) == 1
    regions = [find_region(robot) for robot in robots]
    wanted = [{SHUT: 2, OPEN: 1}[half] for half in halves]
    assert [len(region.components) for region in regions] == wanted
    assert (regions[0] == regions[1]) == (halves[0] == halves[1])


def test_a_problem_with_fewer_bodies_is_another_problem_with_its_own_contacts():
    """As in the search for the boundaries that leave no room."""
    whole = clearance_problem(parse_robot(slot(SHUT))).searched[0]
    fewer = whole.without_bodies([whole.bodies[0].name])
    assert fewer != whole
    assert len({whole, fewer}) == 2
    assert len(scene_of(fewer, 0).discs) < len(scene_of(whole, 0).discs)
