# ruff: noqa: E501  (rows of robot files, one a line)
"""Components of regions with bodies, asked of exact numbers: scenes, and what touches."""

from dataclasses import replace

import pytest

from cspace import find_region, load_robot
from cspace.proofs import Unproved
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.proofs.exact.region import prove_region
from cspace.region import Region
from engine_support.arms_in_planes import scene
from engine_support.gate import UPPER, gate
from engine_support.scenes import random_scene


def loops(region: Region) -> list[tuple[int, tuple[bool, bool]]]:
    return [(len(c.loops), c.wraps) for c in region.components]


@pytest.mark.parametrize("obstacles", [1, 3, 10])
@pytest.mark.parametrize("kinds", ["RR", "RP", "PR", "PP"])
def test_components_amid_obstacles_are_those_of_exact_numbers(tmp_path, kinds, obstacles):
    """Convex links; obstacles of all shapes, some of them hooks. Every plane has its turn."""
    seed = {"RR": 4, "RP": 6, "PR": 7, "PP": 7}[kinds]
    file = tmp_path / "scene.toml"
    file.write_text(scene(seed, kinds, "xyz"[seed % 3], obstacles), encoding="utf-8")
    region = find_region(load_robot(file))
    proved = prove_region(exact_problem(exact_robot(file)), region)
    assert [(part.loops, part.wraps) for part in proved.components] == loops(region)
    for part, component in zip(proved.components, region.components, strict=True):
        assert abs(float(part.area) - component.area) < 1e-9 * region.area


@pytest.mark.parametrize("seed", [12, 18, 46, 53])
def test_random_scenes_are_those_of_exact_numbers(seed):
    """In 46 and 53 bodies are cut, and no distance is kept."""
    robot = random_scene(seed)
    region = find_region(robot)
    proved = prove_region(exact_problem(exact_robot(robot)), region)
    assert [(part.loops, part.wraps) for part in proved.components] == loops(region)


# --- bodies that nearly touch ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("top", "count"), [("2.30000001", 1), ("2.3000000000001", 1), ("2.3", 2), ("2.29999999", 2)]
)
def test_less_than_a_nanometre_decides_whether_a_gate_is_passed(tmp_path, top, count):
    """As wide as the disc it is no gate: what touches joins no components."""
    file = tmp_path / "gate.toml"
    file.write_text(gate("disc", UPPER.format(top)), encoding="utf-8")
    region = find_region(load_robot(file))
    assert len(prove_region(exact_problem(exact_robot(file)), region).components) == count


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
"""Two components; in doubles one critical value may come out twice, and specks between the two."""


def test_a_scene_in_which_doubles_saw_specks_has_two_components(tmp_path):
    file = tmp_path / "slit.toml"
    file.write_text(SLIT, encoding="utf-8")
    exact, region = exact_problem(exact_robot(file)), find_region(load_robot(file))
    found = {(part.loops, part.wraps) for part in prove_region(exact, region).components}
    assert found == {(2, (False, True)), (1, (False, False))}
    speck = replace(region.components[0], area=4e-10, contains_home=False)
    with pytest.raises(Unproved, match="4 components are proposed, and there are 2"):
        prove_region(exact, replace(region, outlined=(*region.components, speck, speck)))
