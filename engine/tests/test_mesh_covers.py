"""Meshes nobody would draw: each is covered to its last triangle, or refused in a sentence."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from cspace.geometry import solid_covers
from cspace.geometry.covering import PER_CORNER, Work, few, uncovered, within
from cspace.geometry.mesh_solids import SurfaceDistance, convex_solid, one_a_cell
from cspace.geometry.solid_covers import mesh_cover

RNG = np.random.default_rng(620)
TURN = 2 * np.pi


def sphere(radius: float, count: int = 24) -> np.ndarray:
    """Triangles of a closed sphere, outward."""
    up = np.linspace(0, np.pi, count // 2 + 1)[:, None, None]
    around = np.linspace(0, TURN, count + 1)[None, :, None]
    grid = np.concatenate([np.sin(up) * np.cos(around), np.sin(up) * np.sin(around)], axis=-1)
    grid = np.concatenate([grid, np.cos(up) + 0 * around], axis=-1)
    grid[:, -1], grid[0], grid[-1] = grid[:, 0], (0, 0, 1), (0, 0, -1)
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    lower, upper = np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)
    return radius * np.concatenate([lower[:-1].reshape(-1, 3, 3), upper[1:].reshape(-1, 3, 3)])


def shell(radius: float, part: float) -> np.ndarray:
    """The solid between a sphere and a smaller one."""
    return np.concatenate([sphere(radius), part * sphere(radius)[:, ::-1]])


def fan(radius: float, count: int = 12) -> np.ndarray:
    """A flat disc."""
    angle = TURN * np.arange(count + 1) / count
    rim = radius * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    return np.stack([0 * rim[1:], rim[:-1], rim[1:]], axis=1)


def apart(distance: float) -> np.ndarray:
    return np.concatenate([sphere(0.1), sphere(0.1) + np.array([distance, 0, 0])])


POINT = np.array([[[0.3, 0.2, 0.1]] * 3])
TRIANGLE = np.array([[[0.0, 0, 0], [0.1, 0, 0], [0, 0.08, 0]]])
NEEDLE = np.array([[[0.0, 0, 0], [2, 0, 0], [2, 1e-9, 0]]])
SEGMENT = np.array([[[0.0, 0, 0], [0.3, 0, 0], [0.1, 0, 0]]])

COVERED = {
    "a thin shell": (shell(0.1, 0.9999), True, 0.03),
    "a thick shell": (shell(0.1, 0.5), True, 0.04),
    "a sphere inside out": (sphere(0.1)[:, ::-1], True, 0.02),
    "parts far apart": (apart(1e3), True, 0.03),
    "half a sphere": (sphere(0.1)[::2], False, 0.02),
    "too small for a normal number": (sphere(1e-320), True, 0.02),
    "large": (sphere(1e12), True, 2e11),
    "a triangle": (TRIANGLE, False, 0.02),
    "a point": (POINT, True, 0.02),
    "a segment": (SEGMENT, False, 0.02),
    "points": (RNG.uniform(-0.1, 0.1, (30, 1, 3)).repeat(3, axis=1), True, 0.02),
    "a needle": (NEEDLE, False, 0.05),
    "a disc": (fan(0.2), False, 0.05),
}


@pytest.fixture
def _coarse(monkeypatch) -> None:
    """Take fewer samples and places, for speed: what is said of a cover does not depend on it."""
    for name, number in {"SAMPLES": 50_000, "DEMANDS": 1500, "PLACES": 800, "STEPS": 20}.items():
        monkeypatch.setattr(solid_covers, f"MOST_{name}", number)


@pytest.mark.usefixtures("_coarse")
@pytest.mark.parametrize("name", COVERED)
def test_no_place_of_a_hostile_mesh_is_left_out(name) -> None:
    triangles, closed, excess = COVERED[name]
    centres, radii, reached = mesh_cover(triangles, closed, excess)
    assert reached <= excess
    weights = np.concatenate([RNG.dirichlet(np.ones(3), 3000), np.eye(3)])
    owners = RNG.integers(0, len(triangles), len(weights))
    places = np.einsum("ni,nij->nj", weights, triangles[owners])
    unit = np.abs(triangles).max()
    assert within(places / unit, centres / unit, radii / unit).any(axis=1).all()


@pytest.mark.usefixtures("_coarse")
@pytest.mark.parametrize(("part", "excess"), [(0.9999, 0.03), (0.5, 0.04)])
def test_balls_of_a_shell_leave_it_by_the_excess_at_most_inward_too(part, excess) -> None:
    centres, radii, _ = mesh_cover(shell(0.1, part), True, excess)
    directions = RNG.normal(size=(4000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    ball = RNG.integers(0, len(radii), 4000)
    away = np.linalg.norm(centres[ball] + radii[ball, None] * directions, axis=1)
    flat = 0.1 * (1 - np.cos(np.pi / 24) ** 2)  # how far a face is nearer to the middle, at most
    assert away.max() <= 0.1 + excess
    assert away.min() >= 0.1 * part - flat - excess


REFUSED = {
    "no triangle": (np.zeros((0, 3, 3)), True, 0.02, "without triangles"),
    "NaN": (np.where(np.arange(9).reshape(3, 3) == 4, np.nan, TRIANGLE), True, 0.02, "no number"),
    "infinite": (np.where(TRIANGLE > 0.09, np.inf, TRIANGLE), True, 0.02, "no number"),
    "huge": (sphere(1e160), True, 0.02, "farther away than"),
    "far beyond the excess": (sphere(1e3), True, 0.02, "too large for an excess of 0.02"),
    "an excess of rounding": (sphere(1.0) + 1e9, True, 1e-6, "is rounding beside a mesh of size"),
    "an excess of nothing": (sphere(1e-160), True, 1e-162, "1e-30 to 1e[+]30 is wanted"),
    "no excess": (TRIANGLE, True, np.nan, "is wanted"),
    "a long needle": (1e4 * NEEDLE, False, 0.02, "too large for an excess of 0.02"),
    "a large disc": (fan(1.0), False, 0.045, "more than 500 balls"),
    "needles": (RNG.uniform(-1, 1, (4000, 3, 3)) * [1, 1e-9, 0], False, 0.02, "too large"),
}


@pytest.mark.usefixtures("_coarse")
@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
@pytest.mark.parametrize("name", REFUSED)
def test_a_mesh_that_cannot_be_covered_is_refused_in_a_sentence(name) -> None:
    triangles, closed, excess, text = REFUSED[name]
    with pytest.raises(ValueError, match=text):
        mesh_cover(triangles, closed, excess)


@pytest.mark.usefixtures("_coarse")
def test_work_is_counted_and_a_cover_that_takes_more_is_refused(monkeypatch) -> None:
    ring, centre = fan(1.0), np.zeros((1, 3))
    work = Work(10**6, "too much")
    assert not len(uncovered(ring, centre, np.array([1.1]), work))
    assert work.left == 10**6 - 3 * len(ring) * (1 + PER_CORNER)
    with pytest.raises(ValueError, match="too much"):
        uncovered(
            ring, centre, np.array([1.1]), Work(3 * len(ring) * (1 + PER_CORNER) - 1, "too much")
        )
    monkeypatch.setattr(solid_covers, "MOST_WORK", 1000)
    with pytest.raises(ValueError, match="too long for an excess of 0"):
        mesh_cover(shell(0.1, 0.9999), True, 0.03)


def test_a_choice_of_too_many_breaks_off() -> None:
    assert len(few(np.eye(50, dtype=bool))) == 50
    assert len(few(np.eye(50, dtype=bool), most=20)) == 21


def test_one_place_of_each_cell_stands_for_its_own() -> None:
    places = RNG.uniform(-1, 1, (500, 3))
    for size, most in ((0.5, 500), (1e-9, 500), (1e-9, 20)):
        first, cell = one_a_cell(places, most, size)
        assert len(first) <= most
        assert (np.diff(first) > 0).all()
        assert (cell[first] == np.arange(len(first))).all()
        assert cell.shape == (500,)
    assert len(first) > 1
    assert [len(x) for x in one_a_cell(np.zeros((0, 3)), 5, 1.0)] == [0, 0]
    first, cell = one_a_cell(places, 500, 0.5)
    away = np.linalg.norm(places - places[first][cell], axis=1)
    assert 0 < away.max() <= 0.5 * np.sqrt(3)


def test_depths_are_lower_bounds_and_nearly_the_distances() -> None:
    """Near the middle of a sphere, too, where all samples are equally near."""
    samples = sphere(1.0, 40).mean(axis=1)
    places = np.concatenate([RNG.normal(0, 0.01, (40, 3)), RNG.uniform(-1, 1, (200, 3))])
    known = SurfaceDistance(samples, 0.1)
    depths, truth = known.depths(places), cdist(places, samples).min(axis=1) - 0.1
    assert (depths <= truth).all()
    assert (depths >= truth - 0.004 * (truth + 0.1) - 1e-9).all()
    found = known.within(places, np.full(240, 0.9))
    assert (truth[found >= 0] < 0.7).all()
    assert (found >= 0)[truth < 0.696].all()
    apart = np.linalg.norm(places - samples[found], axis=1)
    assert (apart[found >= 0] < 0.8).all()


def test_a_sphere_of_many_faces_is_a_convex_solid_and_a_dented_one_is_none() -> None:
    triangles = sphere(0.1, 60)
    solid = convex_solid(triangles, 1e-5)
    assert solid is not None
    assert solid.depths(np.zeros((1, 3)))[0] == pytest.approx(0.1, rel=3e-3)
    dented = np.where(np.isclose(triangles, triangles[700, 0]).all(axis=2)[..., None], 0.99, 1.0)
    assert convex_solid(triangles * dented, 1e-5) is None
