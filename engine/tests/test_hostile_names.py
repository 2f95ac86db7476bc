"""Names of a robot file that would harm whoever reads them, in everything that is written of it.

Each name stands for the robot, both joints, all points and all boundaries, and goes through every
command and every file. What reaches a terminal is one line of letters for each line that was meant;
a table holds no formula; XML, HTML and JSON read back as text.
"""

from __future__ import annotations

import csv
import html
import io
import json
import re
import unicodedata
from dataclasses import replace
from functools import cache
from io import BytesIO
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from bs4 import BeautifulSoup
from matplotlib.figure import Figure

from cspace import Region, find_region, load_robot, save_robot
from cspace.cli import main
from cspace.explorer.page import explore, explorer_page
from cspace.model.robot import Robot
from cspace.model.robotfile import parse_robot, robot_text
from cspace.printable import printable
from engine_support.commands import run
from engine_support.oracles import packaged_table
from lizarraga2025.commands import main as companion

KINDS = ("joint", "point", "boundary")
NAMES = {
    "mathtext": r"$\frac{1}{0}$",
    "ROS": "a_1",
    "backslash": "back\\slash\\",
    "dollars": "$x$ $",
    "underscore first": "_child1",
    "escape": "\x1b[2J\x1b]0;gone\x07",
    "C1 escape": "\x9b31m",
    "bidirectional": "\u202egnp.\u2066exe",
    "newline": "one\ntwo\r\nthree",
    "backspace": "safe\b\b\b\bgone",
    "null": "nu\0ll",
    "separator": "line\u2028paragraph\u2029end",
    "formula": "=HYPERLINK(0)",
    "plus": "+1+1",
    "minus": "-2+3",
    "at": "@SUM(1)",
    "tab": "\t=1+1",
    "return": "\r=1+1",
    "blank": " =1+1",
    "wide formula": "＝1+1",
    "quotes": "\"';--,",
    "script": "</script><script>window.hit=1</script>",
    "image": "<img src=x onerror='window.hit=1'>",
    "comment": "--><!--",
    "cdata": "]]><![CDATA[",
    "entity": "&lt;&#0;&amp;",
    "template": "$name ${data} {0} %s %(x)s",
    "path": "../../etc/passwd",
    "option": "--json",
    "letters": "Größe 肩関節 θ",
}

PACKS = [tuple(NAMES.values())[i : i + 5] for i in range(0, len(NAMES), 5)]
"""Five names a robot, for what takes long: each is a boundary's, a point's and a part of a line."""


def hostile(*names: str) -> dict:
    """The packaged robot with these names in turn; what they had before tells them apart.

    A boundary in use has each of five names, also one that matplotlib would leave out of a legend.
    """
    table = packaged_table()
    new = {
        row["name"]: f"{names[i % len(names)]}{row['name']}"
        for kind in KINDS
        for i, row in enumerate(sorted(table[kind], key=lambda row: not row.get("used", True)))
    }
    for row in (row for kind in KINDS for row in table[kind]):
        row["name"] = new[row["name"]]
        if "points" in row:
            row["points"] = [new[point] for point in row["points"]]
        if "point" in row:
            row["point"] = new[row["point"]]
    home = {joint["name"]: 0.0 for joint in table["joint"]}
    return table | {"home": home, "tool": new[table["tool"]], "name": names[-1]}


@pytest.fixture(params=NAMES.values(), ids=NAMES.keys())
def name(request, tmp_path, monkeypatch) -> str:
    """A name; the working directory has a robot file that is full of it."""
    monkeypatch.chdir(tmp_path)
    save_robot(parse_robot(hostile(request.param)), "arm.toml")
    return request.param


@pytest.fixture(params=PACKS, ids=range(len(PACKS)))
def pack(request) -> tuple[str, ...]:
    return request.param


@pytest.fixture
def robot(pack, tmp_path, monkeypatch) -> Robot:
    """A robot with five of the names, which the working directory has as a file."""
    monkeypatch.chdir(tmp_path)
    robot = parse_robot(hostile(*pack))
    save_robot(robot, "arm.toml")
    return robot


@cache
def region_of(names: tuple[str, ...]) -> Region:
    return find_region(parse_robot(hostile(*names)))


@pytest.fixture
def region(pack) -> Region:
    """The region of the robot with these names."""
    return region_of(pack)


def harmless(text: str) -> bool:
    """Whether a terminal would only show letters, and lines as they were meant."""
    kinds = {unicodedata.category(letter) for letter in text.replace("\n", "")}
    return not kinds & {"Cc", "Cf", "Cs", "Zl", "Zp"}


SAFE, REFUSED = (
    {
        "region": "region arm.toml",
        "a safe pose": "contains arm.toml 20deg -45deg",
        "an unsafe pose": "contains arm.toml 80deg 0deg",
        "traverse": "traverse arm.toml 2 3 4",
        "workspace": "workspace arm.toml --at=-45,20 --go 0,0 0,170deg",
        "certify": "certify arm.toml --scale 0.9 -o cert.json",
        "refute": "certify arm.toml --scale 1.2",
        "check": "check cert.json arm.toml",
        "connected": "connected arm.toml 0 0 10deg 10deg",
        "explore": "explore arm.toml -o page.html",
    },
    {
        "a value that is none": "contains arm.toml bad 0",
        "too few values": "contains arm.toml 0",
        "an unknown joint": "region arm.toml --slice bad=1",
        "too many held": "region arm.toml --slice {}=1deg",
    },
)
"""All but `draw`, whose lines hold no name."""


def test_no_command_lets_a_name_act_on_the_terminal(capsys, robot) -> None:
    lines = {}
    for what, command in (SAFE | REFUSED).items():
        status, out, err = run(
            capsys, *(word.replace("{}", robot.joints[0].name) for word in command.split(" "))
        )
        assert status in ((0, 1) if what in SAFE else (2,)), what
        assert harmless(out + err), what
        assert err.count("\n") <= 1, what
        lines[what] = out.splitlines()
    shown = " ".join(lines["an unsafe pose"])
    assert all(printable(boundary.name) in shown for boundary in robot.boundaries if boundary.used)


def test_files_and_standard_output_have_names_back_or_harmless(capsys, name) -> None:
    """JSON, GeoJSON and NumPy arrays have the name as it is, whatever a terminal would do."""
    assert (
        run(capsys, "region arm.toml --json r.json --geojson g.json --npz r.npz --csv t.csv")[0]
        == 0
    )
    joints = [f"{name}q1", f"{name}q2"]
    region = json.loads(Path("r.json").read_text())
    assert (region["robot"], region["joints"]) == (name, joints)
    (feature, *_) = json.loads(Path("g.json").read_text())["features"]
    assert feature["properties"]["joints"] == joints
    with np.load("r.npz", allow_pickle=False) as arrays:
        assert arrays["joints"].tolist() == joints
    assert load_robot("arm.toml").name == name
    for file in ("r.json", "g.json", "t.csv"):  # what `--json -` and its like print
        assert harmless(Path(file).read_text("utf-8"))
    a_table_of_numbers_and_texts("t.csv", joints[0])


def test_tables_of_paths_and_samples_have_harmless_names(capsys, robot) -> None:
    assert run(capsys, "traverse arm.toml 1 2 --scale 0.9 --csv t.csv")[0] == 0
    names = [joint.name for joint in robot.joints]
    a_table_of_numbers_and_texts("t.csv", names[0])


def a_table_of_numbers_and_texts(file: str, joint: str) -> None:
    """No cell begins a formula, every line is a row, and numbers stay numbers."""
    text = Path(file).read_text("utf-8")
    header, *rows = csv.reader(io.StringIO(text))
    assert text.count("\n") == 1 + len(rows)
    assert not [cell for cell in header if re.match(r"\s*[=+\-@\t\r＝＋－＠]", cell)]
    assert all(map(harmless, header))
    assert any(printable(f"{joint}_rad") in cell for cell in header)
    numbers = [cell for row in rows for cell in row if cell]
    assert any(cell.startswith("-") for cell in numbers)
    assert np.isfinite([float(cell) for cell in numbers]).all()


PICTURES = [
    "region arm.toml --svg p.svg",
    "draw arm.toml -o p.svg",
    "traverse arm.toml 1 2 3 --scale 0.9 --svg p.svg",
    "workspace arm.toml --svg p.svg",
]
ELEMENTS = {
    "svg", "metadata", "defs", "style", "g", "path", "use", "clipPath", "rect", "image",
    "RDF", "Work", "type", "date", "format", "creator", "Agent", "title",
}  # fmt: skip


@pytest.mark.filterwarnings("ignore:Glyph")  # matplotlib's own font has no letters of Asia
@pytest.mark.parametrize("line", PICTURES)
def test_every_picture_is_drawn_and_its_names_are_text(capsys, robot, line) -> None:
    assert run(capsys, line)[0] == 0
    svg = Path("p.svg").read_text("utf-8")
    root = ElementTree.fromstring(svg)
    assert harmless(svg)
    assert {element.tag.rpartition("}")[2] for element in root.iter()} <= ELEMENTS
    assert not [key for element in root.iter() for key in element.attrib if key.startswith("on")]
    notes = " ".join(html.unescape(note) for note in re.findall(r"<!-- (.*?) -->", svg, re.DOTALL))
    used = [boundary.name for boundary in robot.boundaries if boundary.used]
    names = [*(joint.name for joint in robot.joints), *used[-1:]]
    posed = [f"{joint.name} = 0°" for joint in robot.joints]
    shown = {"workspace": used, "region": names[:2], "draw": [*names, *posed]}
    for name in shown.get(line.partition(" ")[0], names):
        assert printable(name).replace("--", "- -") in notes.replace("--", "- -")


@pytest.mark.filterwarnings("ignore:Glyph")
@pytest.mark.parametrize("kind", ["pdf", "png", "eps"])
def test_a_plot_of_ones_own_is_saved_in_every_format(region, kind) -> None:
    figure, buffer = Figure(), BytesIO()
    axes = region.plot(figure.subplots())
    assert printable(region.robot.joints[0].name) in axes.get_xlabel().replace(r"\$", "$")
    figure.savefig(buffer, format=kind)
    assert len(buffer.getvalue()) > 1000


def test_what_python_shows_of_it_is_one_harmless_line(pack, region) -> None:
    named = [replace(region.robot, name=name) for name in pack]
    vertices = [vertex for part in region.components for vertex in part.vertices]
    arcs = [arc for part in region.components for loop in part.loops for arc in loop]
    for shown in (*named, region, region.problem, *arcs, *vertices, explore(region)):
        assert harmless(repr(shown))
        assert "\n" not in repr(shown)
    with pytest.raises(ValueError, match="two joints") as caught:
        find_region(region.robot, {0: 0.1})
    assert harmless(str(caught.value))


def tags_of(text: str) -> list[str]:
    return [tag.name for tag in BeautifulSoup(text, "html.parser").find_all(True)]


@cache
def usual_tags() -> list[str]:
    return tags_of(explorer_page(find_region(load_robot("minervabot-v2"))))


def test_the_explorers_page_has_the_same_tags_whatever_the_names(region) -> None:
    text = explorer_page(region)
    page = BeautifulSoup(text, "html.parser")
    assert tags_of(text) == usual_tags()
    assert [key for tag in page.find_all(True) for key in tag.attrs if key.startswith("on")] == []
    assert printable(region.robot.name) in page.get_text()
    assert harmless(text)


def test_in_the_browser_names_stay_text(open_quietly, region, tmp_path) -> None:
    """Chromium: nothing runs, nothing complains, and the page says the names."""
    robot, file = region.robot, tmp_path / "page.html"
    file.write_text(explorer_page(region), encoding="utf-8")
    page = open_quietly(file.as_uri())
    assert page.evaluate("window.hit") is None
    assert " ".join(page.inner_text("h1").split()) == " ".join(printable(robot.name).split())
    told = page.text_content("live-figure table")
    assert all(printable(boundary.name) in told for boundary in robot.boundaries if boundary.used)


@pytest.mark.filterwarnings("ignore:Glyph")
def test_a_picture_within_a_page_runs_nothing_in_the_browser(tabs, region, tmp_path) -> None:
    """As Jupyter shows a region."""
    svg, file = region._repr_svg_(), tmp_path / "p.html"
    file.write_text(f"<!doctype html><body>{svg[svg.index('<svg') :]}", encoding="utf-8")
    with tabs.lent() as tab:
        tab.page.goto(file.as_uri())
        assert tab.page.evaluate("window.hit") is None
        assert tab.page.evaluate("document.body.children.length") == 1


# --- names that the user types: files, keys, values, options -------------------------------------

EVIL = "x\x1b[31m\u202e\ny"
TYPED = {
    "a robot": ["region", EVIL],
    "a folder": ["region", "minervabot-v2", "--json", f"{EVIL}/x"],
    "an ending": ["draw", "minervabot-v2", "-o", f"a.{EVIL}"],
    "a value": ["contains", "minervabot-v2", EVIL, "0"],
    "a box": ["certify", "minervabot-v2", "--box", f"q1={EVIL}:1", "q2=0:1"],
    "a certificate": ["check", EVIL],
    "a packaged name": ["robots", "show", EVIL],
    "an entry": ["claims", EVIL],
    "a command": [EVIL],
    "an option": ["region", "minervabot-v2", f"--{EVIL}"],
    "a number": ["why", "minervabot-v2", "0", "0", "1", "1", "--seed", EVIL],
}


@pytest.mark.parametrize("words", TYPED.values(), ids=TYPED.keys())
def test_what_is_typed_is_quoted_harmlessly(capsys, tmp_path, monkeypatch, words) -> None:
    monkeypatch.chdir(tmp_path)
    try:
        status = (companion if words[0] in ("claims", "results") else main)(words)
    except SystemExit as stop:
        status = stop.code
    out, err = capsys.readouterr()
    assert status == 2
    assert out == "" or words[0] == "check"  # its verdict, none, is what it prints
    assert harmless(out + err)
    assert not [line for line in (out + err).splitlines() if line.startswith("y")]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('name = "MinervaBotV2"', f'{json.dumps(EVIL)} = 1\nname = "x"'),
        ('length_unit = "cm"', f"length_unit = {json.dumps(EVIL)}"),
        ('tool = "3"', f"tool = {json.dumps(EVIL)}"),
        ("schema = 1", "schema = \x1b[31m"),
        ("home = {", f"home = {{ {json.dumps(EVIL)} = 1, "),
    ],
)
def test_what_is_wrong_in_a_file_is_quoted_harmlessly(capsys, tmp_path, old, new) -> None:
    text = robot_text("minervabot-v2")[0]
    assert old in text
    file = tmp_path / f"{EVIL}.toml"
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    assert main(["region", str(file)]) == 2
    err = capsys.readouterr().err
    assert harmless(err)
    assert err.count("\n") == 1
    with pytest.raises(ValueError, match="toml") as caught:
        load_robot(file)
    assert harmless(str(caught.value))
