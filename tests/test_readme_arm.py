"""README's section about an arm of six joints: every command in it runs, and says what it says."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from qbound.cli import main

ROOT = Path(__file__).parents[1]
HEADING = "### An arm of six joints"
COARSER = {"0.1": "0.25"}
"""Values that are exchanged: an edge of voxels, which only takes longer where it is short."""

SAYS = {
    "import": (0, "29 balls, 193 pairs"),
    "why": (1, "falls into 3 ranges"),
    "check": (0, "proved: no path from (0, -90, 90, -90, -90, 0) to (0, -90, 270, -90, -90, 0)"),
    "region": (0, "3 components"),
    "fibre": (0, "wrist_1_joint with shoulder_pan_joint = 0 deg"),
    "allowed": (0, "base_link, upper_arm_link      never"),
    "reach": (0, "exact along"),
    "surface": (0, "triangles"),
}


def section() -> str:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    start = text.index(HEADING)
    return text[start : text.index("\n## ", start)]


def commands() -> list[list[str]]:
    blocks = re.findall(r"(?s)```console\n(.*?)```", section())
    lines = [line for block in blocks for line in block.splitlines()]
    words = [shlex.split(line, comments=True) for line in lines if line.strip()]
    assert words[0][:2] == ["pip", "install"]
    assert {row[0] for row in words[1:]} == {"qbound"}
    return [row[1:] for row in words[1:]]


def test_the_commands_about_an_arm_run_in_their_order_and_say_what_is_said_of_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    run = commands()
    assert [words[0] for words in run] == list(SAYS)
    for words in run:
        status, says = SAYS[words[0]]
        assert main([COARSER.get(word, word) for word in words]) == status
        assert says in capsys.readouterr().out
        for word in words:
            if re.fullmatch(r"\w+\.(svg|json|toml|html|srdf)", word) and word != "ur5.srdf":
                assert (tmp_path / word).stat().st_size > 500
    assert "Its travel falls into three ranges" in " ".join(section().split())
