"""Numbers of regions that are not right yet, with their right answers."""

from pathlib import Path

import mpmath
import numpy as np
import pytest

from cspace import find_region, load_robot
from cspace.region.region import _over

AGAIN = "mended with the issue the region again"


def region_of(name: str):
    return find_region(load_robot(Path(__file__).with_name(f"{name}.toml")))


@pytest.mark.xfail(strict=True, reason=f"an area in doubles leaves the region unresolved: {AGAIN}")
def test_a_link_that_is_6e_15_too_long_between_two_walls_has_a_region():
    """Its tip keeps within 1.979999999999994 m, so it stops 8e-8 rad before it stands upright."""
    region = region_of("walls-parallel")
    assert region.unresolved == ()
    (component,) = region.components
    with mpmath.workdps(40):
        steepest = mpmath.asin(mpmath.mpf("1.899999999999994") / mpmath.mpf("1.9"))
    assert component.area == pytest.approx(float(12 * steepest), rel=1e-12)


@pytest.mark.xfail(strict=True, reason=f"arcs about a tiny disc are chords: {AGAIN}")
def test_arcs_about_a_tiny_disc_lie_on_its_boundary():
    region, radius = region_of("thin-disc"), 9e-8
    arcs = [a for c in region.components for loop in c.loops for a in loop if a.form is not None]
    for arc in (arc for arc in arcs if arc.boundary == "L2, o0"):
        margins = region.margins(arc.at(np.linspace(0, 1, 9)))
        column = region.boundaries.index(arc.boundary)
        assert np.abs(margins[:, column]).max() < 1e-3 * radius


@pytest.mark.xfail(strict=True, reason=f"a vertex moves an arc over a joint limit: {AGAIN}")
def test_no_arc_runs_beyond_a_joint_limit():
    asked = region_of("stretched").problem
    for base in (0, 1):
        for component in _over(asked, asked.free_home, base, 1.0).outlined:
            q = np.concatenate([arc.points for loop in component.loops for arc in loop])
            for values, (low, high) in zip(q.T, asked.ranges, strict=True):
                assert low - 1e-12 <= values.min()
                assert values.max() <= high + 1e-12


@pytest.mark.xfail(strict=True, reason=f"polygons of a component that goes round: {AGAIN}")
def test_polygons_of_a_component_with_holes_that_goes_round_a_joint_are_valid():
    region = region_of("slit-and-round")
    drawn = region.to_shapely(1e-3)
    assert drawn.is_valid
    assert drawn.area == pytest.approx(region.area, abs=1e-2)
