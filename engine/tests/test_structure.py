"""Components of regions with bodies, asked of exact numbers: scenes, and what touches."""

import pytest

from cspace import find_region
from cspace.model.robotfile import parse_robot
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.proofs.exact.region import prove_region
from cspace.region import Region
from engine_support import body_scenes
from engine_support.gate import UPPER, gate


def loops(region: Region) -> list[tuple[int, tuple[bool, bool]]]:
    return [(len(c.loops), c.wraps) for c in region.components]


@pytest.mark.parametrize("obstacles", [1, 3, 10])
@pytest.mark.parametrize("kinds", ["RR", "RP", "PR", "PP"])
def test_components_amid_obstacles_are_those_of_exact_numbers(kinds, obstacles):
    """Links and obstacles of all shapes. Every plane has its turn."""
    plane = ("xy", "xz", "yz")[obstacles % 3]
    robot = parse_robot(body_scenes.ordinary(4, kinds, plane, obstacles))
    region = find_region(robot)
    proved = prove_region(exact_problem(exact_robot(robot)), region)
    assert [(part.loops, part.wraps) for part in proved.components] == loops(region)
    for part, component in zip(proved.components, region.components, strict=True):
        assert abs(float(part.area) - component.area) < 1e-9 * region.area


@pytest.mark.parametrize("seed", [13, 16, 32, 36])
def test_scenes_in_whole_numbers_are_those_of_exact_numbers(seed):
    """In 13 and 32 no distance is kept but for rounding, and bodies are cut."""
    robot = body_scenes.robot(body_scenes.scene(seed))
    region = find_region(robot)
    proved = prove_region(exact_problem(exact_robot(robot)), region)
    assert [(part.loops, part.wraps) for part in proved.components] == loops(region)


# --- bodies that nearly touch ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("top", "count"), [("2.30000001", 1), ("2.3000000000001", 1), ("2.3", 2), ("2.29999999", 2)]
)
def test_less_than_a_nanometre_decides_whether_a_gate_is_passed(top, count):
    """As wide as the disc it is no gate: what touches joins no components."""
    robot = parse_robot(gate("disc", UPPER.format(top)))
    assert (
        len(prove_region(exact_problem(exact_robot(robot)), find_region(robot)).components) == count
    )
