"""Regions that the page finds among obstacles: as many as the library's, and as large."""

from __future__ import annotations

import numpy as np
import pytest

from engine_support.live_scenes import (
    page,
    random_scene,
    scene_in_quarters,
    scene_with_slit,
    shares_in_library,
    shares_in_page,
)  # fmt: skip

SCENES = 20


def check(scene):
    found, expected = shares_in_page(page(), scene), shares_in_library(scene)
    assert len(found) == len(expected)
    assert found == pytest.approx(expected, abs=1e-3)


FOLD_AT_A_CORNER = (40, 2992)
"""Two contacts take turns 1e-8 rad before the fold in which both end."""


@pytest.mark.parametrize("seed", [*((41, k) for k in range(SCENES)), FOLD_AT_A_CORNER])
def test_regions_of_a_random_scene_are_the_librarys(seed):
    check(random_scene(np.random.default_rng(seed)))


@pytest.mark.parametrize("seed", range(SCENES))
def test_no_region_is_lost_or_joined_where_one_is_about_to_change(seed):
    check(scene_with_slit(np.random.default_rng([42, seed]), page()))


@pytest.mark.parametrize("seed", range(SCENES))
def test_what_touches_or_meets_exactly_is_no_way(seed):
    check(scene_in_quarters(np.random.default_rng([44, seed])))


@pytest.mark.parametrize("radius", [0.15, 0.2])
@pytest.mark.parametrize("room", [-1e-6, 0, 1e-6])
def test_a_link_that_touches_in_every_pose_is_a_wall(radius, room):
    """Two discs that the elbow just touches, or the whole upper arm: then no path leads past."""
    at = 1 + 0.05 + radius + room
    discs = [
        {"name": f"{x}", "radius": radius, "corners": [[x, 0.0]]}
        for x in (round(at, 9), -round(at, 9))
    ]
    links = [{"length": 1, "radius": 0.05}, {"length": 0.5, "radius": 0.05}]
    scene = {"links": links, "obstacles": discs}
    assert len(shares_in_page(page(), scene)) == (1 if room > 0 else 2)
    check(scene)
