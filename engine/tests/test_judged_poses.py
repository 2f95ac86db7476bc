"""Poses that are called feasible, beside judges that share no code with the library.

`engine/benchmarks/shapes.py` asks the same of every packaged and imported arm, and of more poses.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

from cspace import load_robot, packaged_robots
from engine_support.judged_poses import gaps, judged_file, judged_urdf, poses
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
    table = tomllib.loads(FILES["minervabot-v2.toml"].read_text(encoding="utf-8"))
    q, feasible = poses(load_robot("minervabot-v2"), 300)
    assert gaps(table, q)[frozenset("12")][feasible].min() < -1
    links = UrdfJudge(URDFS / "torso.urdf")
    folded = {"torso_1": np.zeros(2), "torso_2": np.array([0.0, -2.6])}
    pair = frozenset(("thigh", "trunk"))
    upright, down = (gaps[pair] for gaps in links.gaps(folded, [pair]))
    assert upright > 0.01 > -0.01 > down
