"""Numbers of regions that are not right yet, with their right answers."""

from pathlib import Path

import numpy as np
import pytest

from cspace import find_region, load_robot

AGAIN = "mended with the issue the region again"


def region_of(name: str):
    return find_region(load_robot(Path(__file__).with_name(f"{name}.toml")))


@pytest.mark.xfail(strict=True, reason=f"arcs about a tiny disc are chords: {AGAIN}")
def test_arcs_about_a_tiny_disc_lie_on_its_boundary():
    region, radius = region_of("thin-disc"), 9e-8
    arcs = [a for c in region.components for loop in c.loops for a in loop if a.form is not None]
    for arc in (arc for arc in arcs if arc.boundary == "L2, o0"):
        margins = region.margins(arc.at(np.linspace(0, 1, 9)))
        column = region.boundaries.index(arc.boundary)
        assert np.abs(margins[:, column]).max() < 1e-3 * radius


@pytest.mark.xfail(strict=True, reason=f"polygons of a component that goes round: {AGAIN}")
def test_polygons_of_a_component_with_holes_that_goes_round_a_joint_are_valid():
    region = region_of("slit-and-round")
    drawn = region.to_shapely(1e-3)
    assert drawn.is_valid
    assert drawn.area == pytest.approx(region.area, abs=1e-2)
