"""The front page and the page on related work: one rule, no dead link, every reference used."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BOOK = ROOT / "book"
FRONT = (BOOK / "index.md").read_text(encoding="utf-8")
SOURCES = [*sorted(BOOK.glob("*.md")), *sorted((ROOT / "notebooks").glob("*.md"))]

CITED = re.compile(r"\{cite(?::\w+)?\}`([^`]+)`")
ENTRY = re.compile(r"(?m)^@\w+\{(\w+),")
RESULT = re.compile(r"\{result\}`(\w+):([^`|\[]+?)\s*(?:\||`)")

NAMED_WITH_ITS_RULE = ("proof", "clearance.components")
"""The one number of the front page by another rule: its sentence says which."""


def test_every_entry_of_the_bibliography_is_cited_and_every_citation_has_one():
    listed = ENTRY.findall((BOOK / "references.bib").read_text(encoding="utf-8"))
    groups = [group for file in SOURCES for group in CITED.findall(file.read_text("utf-8"))]
    assert sorted(listed) == sorted({key.strip() for group in groups for key in group.split(",")})


def test_the_numbers_of_the_front_page_follow_the_papers_rule():
    wanted = set(RESULT.findall(FRONT)) - {NAMED_WITH_ITS_RULE}
    assert {rule_of(*one) for one in wanted} <= {"windows", "none"}
    assert {name for file, name in wanted if rule_of(file, name) == "windows"} >= {
        "largest_scale.area",
        "workspace.area.paper",
    }
    assert ":rule: windows" in FRONT  # and so does the arm above them


def rule_of(file: str, name: str) -> str:
    """Return the rule by which a number was recorded."""
    content = json.loads((ROOT / "results" / f"{file}.json").read_text(encoding="utf-8"))
    [rule] = [entry["reading"] for entry in content["results"] if entry["id"] == name]
    return rule


def test_the_covers_are_what_their_script_draws(tmp_path):
    fonts = os.environ | {"MPLCONFIGDIR": str(tmp_path)}  # none but matplotlib's own, listed anew
    subprocess.run(
        [sys.executable, BOOK / "cover.py", tmp_path / "cover.svg"], env=fonts, check=True
    )
    for name in ("cover.svg", "cover-narrow.svg"):
        same_drawing(tmp_path / name, BOOK / "_static" / name)


def same_drawing(one, other):
    """Each number of the drawing, to a tenth of a point: other systems round differently."""
    drawn, committed = (file.read_text("utf-8") for file in (one, other))
    number = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"
    assert re.sub(number, "#", drawn) == re.sub(number, "#", committed)
    mine, theirs = ([float(x) for x in re.findall(number, t)] for t in (drawn, committed))
    assert mine == pytest.approx(theirs, abs=0.1)


def test_the_picture_of_an_arm_in_readme_is_what_its_command_draws(tmp_path):
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    [robot] = re.findall(r"(?s)```toml\n(.*?)```", readme)
    (tmp_path / "arm.toml").write_text(robot, encoding="utf-8")
    command = [sys.executable, "-m", "cspace", "draw", "arm.toml", "-o", "arm.svg"]
    assert " ".join(command[2:]) in readme
    fonts = os.environ | {"MPLCONFIGDIR": str(tmp_path)}
    subprocess.run(command, cwd=tmp_path, env=fonts, check=True, capture_output=True)
    assert 'src="book/_static/own-arm.svg"' in readme
    same_drawing(tmp_path / "arm.svg", BOOK / "_static" / "own-arm.svg")


def test_the_findings_of_readme_state_recorded_numbers():
    entries = {
        entry["id"]: entry
        for file in ("region", "theorem_2")
        for entry in json.loads((ROOT / "results" / f"{file}.json").read_text("utf-8"))["results"]
    }
    recorded = {name: entry["value"] for name, entry in entries.items()}
    q1, q2 = recorded["vertex.5"]
    wanted = [q1, q2, q1 - 180, recorded["beta_{3,3,2}.arctan"]]
    wanted += [recorded[name] for name in ("polygon.area", "paper.area", "largest_scale.area")]
    _, _, text = (ROOT / "README.md").read_text(encoding="utf-8").partition("## What holds")
    stated = re.findall(r"-?\d+\.\d{3}", text.partition("\n## ")[0])
    assert stated == [f"{value:.3f}" for value in wanted]
    areas = (entries[name] for name in ("polygon.area", "paper.area"))
    assert {f"{area['input_uncertainty']:.2f}" for area in areas} == {*re.findall(r"± (\S+)", text)}
