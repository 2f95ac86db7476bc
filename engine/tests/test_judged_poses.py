"""Poses that are called feasible, beside judges that share no code with the library.

`engine/benchmarks/shapes.py` asks the same of every packaged and imported arm, and of more poses.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from cspace import load_robot, packaged_robots
from engine_support.judged_poses import judged_file, judged_urdf, poses
from engine_support.shape_judge import ShapeJudge, separation
from engine_support.urdf_judge import UrdfJudge

ROOT = Path(__file__).parents[2]
FOLDERS = [ROOT / "engine" / "cspace" / "robots", ROOT / "src" / "qbound" / "robots"]
FILES = {file.name: file for folder in FOLDERS for file in folder.iterdir()}
URDFS = Path(__file__).parent / "urdfs"


@pytest.mark.parametrize("name", packaged_robots())
def test_margins_of_a_robot_file_are_the_judges(name: str) -> None:
    found = judged_file(FILES[f"{name}.toml"], 300)
    assert found.feasible > 300
    assert (found.wrong, found.lost) == ([], 0)


@pytest.mark.parametrize(
    ("file", "options"),
    [
        (FILES["ur5.urdf"], {"srdf": FILES["ur5.srdf"]}),
        (URDFS / "tool.urdf", {"neighbours": True}),
        (URDFS / "torso.urdf", {"srdf": URDFS / "torso.srdf"}),
    ],
    ids=["ur5", "tool", "torso"],
)
def test_links_of_an_imported_arm_are_apart_in_feasible_poses(file: Path, options) -> None:
    found = judged_urdf(file, 100, **options)
    assert found.feasible > 100
    assert found.wrong == []


def test_the_judges_see_what_is_left_out() -> None:
    """Links of a file with points alone meet in feasible poses; so do neighbours of a URDF."""
    robot = load_robot("minervabot-v2")
    judge = ShapeJudge(FILES["minervabot-v2.toml"].read_text(encoding="utf-8"))
    q, feasible = poses(robot, judge.limits, 300)
    deepest = {pair: gap[feasible].min() for pair, gap in judge.gaps(q).items()}
    assert deepest[frozenset("12")] < -5
    links = UrdfJudge(URDFS / "torso.urdf")
    folded = {"torso_1": np.zeros(2), "torso_2": np.array([0.0, -2.6])}
    pair = frozenset(("thigh", "trunk"))
    upright, down = (gaps[pair] for gaps in links.gaps(folded, [pair]))
    assert upright > 0.01 > -0.01 > down


@pytest.mark.parametrize("seed", range(20))
def test_separation_is_the_distance_of_convex_shapes(seed: int) -> None:
    """Polygons, segments and points beside shapely; where they meet, how far to push them."""
    rng = np.random.default_rng(seed)
    one, other = (
        np.array(shapely.MultiPoint(rng.normal(size=(k, 2))).convex_hull.exterior.coords)[:-1]
        if k > 2
        else rng.normal(size=(k, 2))
        for k in rng.integers(1, 9, 2)
    )
    shift = rng.normal(size=2) * rng.uniform(0, 3)
    kinds = {1: shapely.Point, 2: shapely.LineString}
    a, b = (kinds.get(len(x), shapely.Polygon)(x) for x in (one, other + shift))
    gap = separation(one[None], (other + shift)[None])[0]
    assert a.distance(b) == pytest.approx(max(gap, 0.0), abs=1e-12)
    directions = np.column_stack([f(np.linspace(0, 2 * np.pi, 3601)) for f in (np.cos, np.sin)])
    pushed = ((directions @ (other + shift).T).min(axis=1) - (directions @ one.T).max(axis=1)).max()
    assert pushed <= gap + 1e-12
    assert pushed == pytest.approx(gap, abs=1e-2)
