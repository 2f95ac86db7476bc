"""Numbers of regions that are not right yet, with their right answers."""

from pathlib import Path

import pytest

from cspace import find_region, load_robot

AGAIN = "mended with the issue the region again"


def region_of(name: str):
    return find_region(load_robot(Path(__file__).with_name(f"{name}.toml")))


@pytest.mark.xfail(strict=True, reason=f"polygons of a component that goes round: {AGAIN}")
def test_polygons_of_a_component_with_holes_that_goes_round_a_joint_are_valid():
    region = region_of("slit-and-round")
    drawn = region.to_shapely(1e-3)
    assert drawn.is_valid
    assert drawn.area == pytest.approx(region.area, abs=1e-2)
