"""The explorer's page: its data are whole, names do no harm, a notebook shows it."""

from __future__ import annotations

import json
import re
from base64 import b64decode
from functools import cache

import pytest
from bs4 import BeautifulSoup

from cspace import find_region, load_robot, packaged_robots
from cspace.cli import main
from cspace.explorer.page import explore, explorer_page
from engine_support.arms import ROBOTS


@cache
def region_of(name):
    return find_region(*ROBOTS[name]())


# --- the data ------------------------------------------------------------------------------------


def test_an_arm_of_balls_is_told_by_its_links():
    """A user read "l3/9, l5/9" where the command says "l3, l5"."""
    robot = load_robot("ur5")
    page = explorer_page(find_region(robot, {0: 0.0, 3: -1.57, 4: -1.57, 5: 0.0}))
    assert "forearm_link, wrist_2_link" in page
    assert not re.search(r"\w+_link/\d", page)


# --- the page ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", packaged_robots())
def test_every_packaged_robot_has_a_page(name, capsys, tmp_path):
    file, robot = tmp_path / "arm.html", load_robot(name)
    assert main(["explore", name, "-o", str(file)]) == 0
    assert capsys.readouterr().err == ""
    assert 10_000 < file.stat().st_size < 300_000
    page = BeautifulSoup(file.read_text(encoding="utf-8"), "html.parser")
    data = json.loads(page.select_one("#robot-data").string)
    assert data["name"] == robot.name
    assert len(robot.joints) > 2 or len(data["regions"]) == len(find_region(robot).components)


@pytest.mark.parametrize("name", ROBOTS)
def test_a_page_is_one_small_file_that_loads_nothing(name):
    page = explorer_page(region_of(name))
    tags = BeautifulSoup(page, "html.parser").find_all(True)
    loaded = {
        tag[key] for tag in tags for key in ("src", "href", "action", "data") if key in tag.attrs
    }
    assert len(page.encode()) < 300_000
    assert [address for address in loaded if not address.startswith(("#", "data:"))] == []
    assert [
        key for tag in tags for key in tag.attrs if key.startswith("on") or key == "style"
    ] == []
    assert [tag.get("id") for tag in tags if tag.name == "script"] == ["robot-data", None]
    assert "default-src 'none'" in page


# --- in a notebook -------------------------------------------------------------------------------


def test_a_notebook_shows_the_picture_and_the_page_in_a_frame_of_its_own(monkeypatch):
    region = region_of("RR")
    shown = explore(region)
    div, image, frame = BeautifulSoup(shown._repr_html_(), "html.parser").find_all(True)
    assert (div.name, image.name, frame.name) == ("div", "img", "iframe")
    assert frame["srcdoc"] == shown.html == explorer_page(region)
    assert frame["sandbox"] == ["allow-scripts"]
    assert b"<svg" in b64decode(image["src"].removeprefix("data:image/svg+xml;base64,"))
    assert "joints" in image["alt"]
    monkeypatch.setattr(type(region), "_repr_svg_", lambda region: None)  # matplotlib is not here
    alone = BeautifulSoup(explore(region)._repr_html_(), "html.parser").find_all(True)
    assert [tag.name for tag in alone] == ["div", "iframe"]


def test_an_explorer_has_a_short_name_and_is_saved_as_the_page(tmp_path):
    shown = explore(region_of("RR"))
    assert re.fullmatch(r"Explorer\('arm', \d+ kB of HTML\)", repr(shown))
    shown.save(tmp_path / "arm.html")
    assert (tmp_path / "arm.html").read_bytes() == shown.html.encode()


# --- the command ---------------------------------------------------------------------------------
