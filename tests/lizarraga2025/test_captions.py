"""What the ledger says of figures, each checked in another way than it was computed.

The tool's place comes from the formulas expanded by hand in `engine_support.oracles`, crossings
from shapely, regions from the boxes and inequalities themselves.
"""

from __future__ import annotations

from itertools import combinations, pairwise, permutations

import numpy as np
import shapely

from cspace import load_robot
from engine_support.oracles import OFFSETS, equation_29
from lizarraga2025 import printed as paper
from lizarraga2025.evidence import tool_paths
from lizarraga2025.readings import in_windows, keeps_geometric
from qbound import window_region
from qbound.windows import window_box

ROBOT = load_robot("minervabot-v2")
HEXAGON = shapely.Polygon(window_region(ROBOT).polygon)


def points(scale=0.95):
    """The six points scaled about the centroid of their polygon's area, shape (6, 2)."""
    shrunk = shapely.affinity.scale(HEXAGON, scale, scale, origin=HEXAGON.centroid)
    return np.array(shrunk.exterior.coords)[:6]


def joint_path(walk, scale=0.95):
    stops, t = points(scale)[list(walk)], np.linspace(0, 1, 300)[:, None]
    return np.concatenate([a + t * (b - a) for a, b in pairwise(stops)])


def tool_path(walk, scale=0.95):
    q = joint_path(walk, scale)
    found = equation_29(q[:, 0], q[:, 1])
    x, z = found["beta_{5,1}"] + OFFSETS["xmin1"], found["beta_{7,3}"] + OFFSETS["zmin1"]
    line = shapely.LineString(np.stack([x, z], -1))
    return shapely.remove_repeated_points(line, tolerance=1e-9)  # each stop stands twice


def rounds(*, back):
    return [
        [(start + sense * i) % 6 for i in range(6 + back)]
        for start in range(6)
        for sense in (1, -1)
    ]


def test_no_caption_announces_an_isometric_view() -> None:
    assert paper.NAMED_VIEW == (2, "isometric")
    assert not [words for words in paper.CAPTIONS.values() if "isometric" in words]


def test_every_walk_round_the_scaled_points_is_feasible() -> None:
    box = window_box(ROBOT)
    for walk in rounds(back=True):
        q = joint_path(walk)
        assert ((box.lower <= q) & (q <= box.upper)).all()
        assert (equation_29(q[:, 0], q[:, 1])["beta_{7,3}"] >= 0).all()


def test_there_are_24_walks_round_six_points_and_six_last_ones() -> None:
    walks = rounds(back=True) + rounds(back=False)
    assert len({tuple(walk) for walk in walks}) == 24
    assert len({walk[-1] for walk in walks}) == 6


def test_every_walk_that_returns_crosses_itself_and_four_that_do_not_return_are_simple() -> None:
    assert not any(tool_path(walk).is_simple for walk in rounds(back=True))
    simple = [walk for walk in rounds(back=False) if tool_path(walk).is_simple]
    assert sorted(simple) == [
        [0, 5, 4, 3, 2, 1],
        [1, 2, 3, 4, 5, 0],
        [4, 3, 2, 1, 0, 5],
        [5, 0, 1, 2, 3, 4],
    ]


def test_the_six_points_put_the_tool_at_six_places() -> None:
    places = [tool_path([i, j]).coords[0] for i in range(6) for j in [(i + 1) % 6]]
    apart = [np.hypot(*np.subtract(a, b)) for a, b in combinations(places, 2)]
    assert min(apart) > 1


def test_52_of_74_directed_orders_have_an_opposite() -> None:
    simple = {walk for walk in permutations(range(6), 5) if tool_path(walk).is_simple}
    opposite = {tuple((i + 3) % 6 for i in walk) for walk in simple}
    assert (len(simple), len(simple & opposite)) == (74, 52)


def test_any_number_and_range_shows_both_colours() -> None:
    box = window_box(ROBOT)
    drawn = np.random.default_rng(3)
    for low, high in ((-np.pi, np.pi), (box.lower, box.upper)):
        for number in (1_000, 100_000):
            free = in_windows(ROBOT, drawn.uniform(low, high, (number, 2)))
            assert 0 < free.mean() < 1


def test_by_the_tools_limit_alone_no_place_has_both_colours() -> None:
    """The limit looks at the height of the tool, which both postures of a place share."""
    q = np.random.default_rng(4).uniform(-np.pi, np.pi, (1000, 2))
    second = tool_paths.arm().other_posture(q)
    places = [
        np.stack([equation_29(*p.T)[name] for name in ("beta_{5,1}", "beta_{7,3}")])
        for p in (q, second)
    ]
    np.testing.assert_allclose(*places, atol=1e-9)
    assert np.abs(q - second).max(axis=-1).min() > 0
    free, other = (keeps_geometric(ROBOT, p) for p in (q, second))
    clear = np.abs(places[0][1]) > 1e-9
    assert (free == other)[clear].all()
    mixed = in_windows(ROBOT, q) & ~in_windows(ROBOT, second)
    assert mixed.any(), "by the windows some place has both"
