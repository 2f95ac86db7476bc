"""Regions that the page finds among obstacles: as many as the library's, and as large."""

from __future__ import annotations

import numpy as np
import pytest

from engine_support.live_scenes import (
    page,
    random_scene,
    scene_with_slit,
    shares_in_library,
    shares_in_page,
)  # fmt: skip

SCENES = 20


def check(scene):
    found, expected = shares_in_page(page(), scene), shares_in_library(scene)
    assert len(found) == len(expected)
    assert found == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("seed", range(SCENES))
def test_regions_of_a_random_scene_are_the_librarys(seed):
    check(random_scene(np.random.default_rng([41, seed])))


@pytest.mark.parametrize("seed", range(SCENES))
def test_no_region_is_lost_or_joined_where_one_is_about_to_change(seed):
    check(scene_with_slit(np.random.default_rng([42, seed]), page()))


@pytest.mark.parametrize("seed", range(10))
def test_nothing_but_numbers_changes_between_two_critical_values(seed):
    scene = random_scene(np.random.default_rng([43, seed]))
    for columns in page()("columnsBetween(scene)", scene=scene):
        assert len({column["ends"] for column in columns}) == 1
        assert all(column["isSame"] for column in columns)
