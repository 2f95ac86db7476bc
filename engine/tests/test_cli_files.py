# ruff: noqa: E501  (rows of robot files, one a line)
"""Files of the command: whole or not at all, several together or none, the same bytes twice."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import shlex
import struct
import subprocess
import sys
import warnings
from email.message import Message
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cspace
import lizarraga2025
from cspace import load_robot
from cspace.cli import COMMANDS, command_parsers, main
from cspace.cli.terminal import write_all
from cspace.files import write_whole
from cspace.model.robotfile import robot_text
from engine_support import urdf
from engine_support.commands import follows_schema, run
from engine_support.oracles import packaged_table, point_seen_from

PACKAGE = Path(cspace.__file__).parent
MINERVA = load_robot("minervabot-v2")
ARM = """
schema = 1
name = "arm"
length_unit = "cm"
angle_unit = "deg"
home = { a = 0, b = 20 }
tool = "t"
joint = [
  { name = "a", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0], axis = [0, 0, 1], limits = [-120, 120], velocity = 90 },
  { name = "b", type = "prismatic", parent = "1", frame = "2", origin = [0, 0, 0], axis = [1, 0, 0], limits = [10, 40], velocity = 20 },
]
point = [
  { name = "t", frame = "2", at = [0, 0, 0] },
  { name = "post", frame = "0", at = [-25, 0, 0] },
]
boundary = [{ name = "P", type = "pair", points = ["post", "t"], clearance = 5 }]
"""


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def arm() -> str:
    Path("arm.toml").write_text(ARM)
    return "arm.toml"


def files() -> set[str]:
    return {path.name for path in Path().iterdir()}


# --- help ----------------------------------------------------------------------------------------


def test_the_help_of_all_leads_to_the_robot_file_and_to_the_manual(capsys) -> None:
    """Who has the wheel alone has no page, and may be offline."""
    out = run(capsys, "--help")[1]
    [schema] = re.findall(r"robot file: every key is in (\S+)", out)
    assert "joint" in json.loads(Path(schema).read_text(encoding="utf-8"))["properties"]
    assert "cspace robots show minervabot-v2" in out
    [code] = re.findall(r'manual: python -c "(.*)"', out)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert done.stdout.decode().startswith("# cspace")


def test_the_help_names_our_addresses_and_no_other(monkeypatch, capsys) -> None:
    found = ["Paper, https://doi.org/x", "Repository, https://example.org/qbound"]
    for known, shown in ((found, True), (found[:1], False)):
        about = Message()
        for url in known:
            about["Project-URL"] = url
        monkeypatch.setattr("importlib.metadata.metadata", lambda _, about=about: about)
        assert ("Repository: https://example.org/qbound" in run(capsys, "--help")[1]) == shown
        assert "doi.org" not in run(capsys, "--help")[1]


def test_every_help_says_what_the_exit_status_means_and_ends_with_an_example() -> None:
    for name, parser in command_parsers().items():
        told = parser.format_help().rstrip()
        assert told.splitlines()[-1].startswith(f"example: {parser.prog}")
        assert name not in COMMANDS or "exit status: 0 " in told


SWEEP = """
schema = 2
robot = "minervabot-v2"
measure = ["region.area"]
vary = [{ number = "joint.q2.origin.0", from = 10, to = 20, count = 2 }]
"""


# --- traverse ------------------------------------------------------------------------------------


def test_a_traversal_by_the_papers_numbers(capsys) -> None:
    line = "traverse minervabot-v2 1 2 3 4 5 6 --scale 0.9 --closed --json -"
    status, out, err = run(capsys, line)
    content = json.loads(out)
    assert (status, err) == (0, "")
    follows_schema(content, "traverse")
    assert content["feasible"]
    assert [stop["name"] for stop in content["stops"]] == list("1234561")
    table = packaged_table()
    for stop in content["stops"]:
        assert_allclose(stop["tool"], point_seen_from(table, "3", "0", stop["q"]), atol=1e-9)
    assert len(content["self_crossings"]) == 1
    assert {m["boundary"] for m in content["margins"]} == {"B1", "B2", "B3", "B4", "B7"}
    for place in content["singular_crossings"]:
        assert place["q"][1] == pytest.approx(np.arctan2(-25.98, 15), abs=1e-9)


def test_a_path_outside_the_region_names_boundary_and_place(capsys) -> None:
    """Point 3 to point 4 straight: under the floor (the paper's own remark)."""
    status, out, _ = run(capsys, "traverse minervabot-v2 2 3 4")
    assert status == 1
    assert "outside: B7 from q1 = 75.79" in out
    content = json.loads(run(capsys, "traverse minervabot-v2 2 3 4 --json -")[1])
    follows_schema(content, "traverse")
    (out_of,) = (m for m in content["margins"] if m["leaves"])
    assert (out_of["boundary"], out_of["leaves"]["leg"]) == ("B7", "3 to 4")
    assert not content["feasible"]


@pytest.mark.parametrize("files", ["--csv -", "--json -", "--csv path.csv --svg path.svg"])
def test_a_path_outside_the_region_is_never_written_in_silence(capsys, files) -> None:
    status, _, err = run(capsys, f"traverse minervabot-v2 2 3 4 {files}")
    assert status == 1
    assert err == "cspace: the path is not feasible: it violates B7, first on 3 to 4\n"
    assert run(capsys, f"traverse minervabot-v2 1 2 --scale 0.9 {files}")[2] == ""


def test_all_arcs_lead_round_the_component(capsys) -> None:
    status, out, _ = run(capsys, "traverse minervabot-v2 --arcs 1 2 3 4 5 6 --json -")
    content = json.loads(out)
    follows_schema(content, "traverse")
    assert status == 0
    assert content["stops"][0]["q"] == pytest.approx(content["stops"][-1]["q"], abs=1e-9)
    assert all(abs(margin["margin"]) < 1e-9 for margin in content["margins"])


def test_arcs_that_do_not_meet_are_joined_and_may_run_backwards(capsys) -> None:
    forth, back = (
        json.loads(run(capsys, f"traverse minervabot-v2 --arcs {order} --json -")[1])
        for order in ("4 1", "-1 -4")
    )
    assert len(forth["stops"]) == len(back["stops"]) == 4
    there = [stop["q"] for stop in forth["stops"]]
    assert_allclose(there, [stop["q"] for stop in back["stops"]][::-1], atol=1e-9)


def test_margins_along_a_path_are_summed_up_by_links(capsys) -> None:
    """A slice of a UR5 printed 205 margins."""
    held = "shoulder_pan_joint=0 wrist_1_joint=-90deg wrist_2_joint=-90deg wrist_3_joint=0"
    status, out, err = run(capsys, f"traverse ur5 1 4 2 --slice {held}")
    least = dict(re.findall(r"smallest margin of (.+?): (\S+) m", out))
    assert len(out.splitlines()) < 45
    assert "upper_arm_link, wrist_1_link" in least
    violated = {links for links, value in least.items() if float(value) < -1e-9}
    assert status == 1
    assert violated == {"base_link, forearm_link", "base_link, wrist_1_link"}
    assert violated <= set(re.findall(r"outside: (.+?) from", out))
    assert "it violates base_link, forearm_link; base_link, wrist_1_link, first on 1 to 4" in err


def test_the_csv_is_the_path_with_units_in_its_header(capsys, arm) -> None:
    status, _, _ = run(capsys, f"traverse {arm} 1 2 --csv path.csv")
    assert status in (0, 1)
    rows = list(csv.reader(io.StringIO(Path("path.csv").read_text())))
    assert rows[0] == ["a_rad", "b_cm", "x_cm", "y_cm", "z_cm"]
    a, b, x, y, z = np.array(rows[1:], dtype=float).T
    assert_allclose([x, y], [b * np.cos(a), b * np.sin(a)], atol=1e-9)
    assert_allclose(z, 0)


# --- progress ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        ("allowed ur5", r"pairs of links: \d+ %"),
        ("certify minervabot-v2 --scale 0.96", r"searching for a proof: \d+ %"),
    ],
)
def test_progress_goes_to_a_terminal_only(capsys, monkeypatch, line, shown) -> None:
    monkeypatch.setattr("cspace.cli.terminal.EVERY", 0.0)
    assert run(capsys, line)[2] == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    err = run(capsys, line)[2]
    assert re.search(shown, err)
    assert err.endswith("\r\033[K")


# --- draw ----------------------------------------------------------------------------------------


def png_size(file: str) -> tuple[int, int]:
    data = Path(file).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", data[16:24])


def test_a_picture_of_region_and_robot_and_of_each_alone(capsys) -> None:
    for name, options in (("both", ""), ("region", "--region"), ("robot", "--robot")):
        assert run(capsys, f"draw minervabot-v2 -o {name}.png {options} --q 20deg -45deg")[0] == 0
    assert png_size("both.png")[0] == 2 * png_size("region.png")[0]
    assert png_size("region.png") == png_size("robot.png")
    assert Path("region.png").read_bytes() != Path("robot.png").read_bytes()


def test_a_pose_that_collides_is_drawn_and_said(capsys) -> None:
    """Without a name the picture has that of the robot."""
    status, out, err = run(capsys, "draw minervabot-v2 --q 1.5rad 0")
    assert (status, out) == (0, "written: minervabot-v2.svg\n")
    assert ElementTree.parse("minervabot-v2.svg").getroot().tag.endswith("svg")
    assert err == "cspace: the pose that is drawn is not feasible: it violates B7\n"


def test_three_joints_are_drawn_with_one_held(capsys) -> None:
    third = '{ name = "c", type = "revolute", parent = "2", frame = "3", origin = [0, 0, 0], axis = [0, 0, 1] },'
    text = ARM.replace("b = 20 }", "b = 20, c = 0 }").replace('tool = "t"', 'tool = "u"')
    text = text.replace(
        "]\npoint = [", f'{third}\n]\npoint = [{{ name = "u", frame = "3", at = [5, 0, 0] }},'
    )
    Path("three.toml").write_text(text)
    status, _, err = run(capsys, "draw three.toml")
    assert status == 2
    assert "3 that are not held" in err
    assert run(capsys, "draw three.toml --slice c=30deg")[0] == 0
    assert "with the home pose" in run(capsys, "region three.toml --slice c=0")[1]
    away = run(capsys, "region three.toml --slice c=30deg")[1]
    assert "with home's values of these joints" in away
    assert "with the home pose" not in away
    status, out, _ = run(capsys, "traverse three.toml 1 2 --slice c=30deg --json -")
    content = json.loads(out)
    follows_schema(content, "traverse")
    assert status in (0, 1)
    assert all(stop["q"][2] == pytest.approx(np.pi / 6) for stop in content["stops"])


# --- the same bytes twice, whole or not at all ---------------------------------------------------


WRITING = [
    "draw minervabot-v2 -o {}.svg",
    "draw minervabot-v2 -o {}.png",
    "region minervabot-v2 --npz {}-region.npz",
    "region minervabot-v2 --svg {}-region.svg",
    "traverse minervabot-v2 1 2 3 --scale 0.8 --svg {}-path.svg",
    "certify minervabot-v2 --scale 0.9 -o {}-certificate.json",
    "allowed ur5 --json {}-allowed.json",
]
ALL_OF_THEM = """
import shlex, sys
from cspace.cli import main
for line in sys.argv[1:]:
    assert main(shlex.split(line)) == 0, line
"""


def test_a_second_run_writes_the_same_bytes(capsys) -> None:
    """The second in another process, in another order, and under other file names."""
    for line in WRITING:
        assert run(capsys, line.format("one"))[0] == 0
    others = [line.format("two") for line in reversed(WRITING)]
    command = [sys.executable, "-c", ALL_OF_THEM, *others]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    written = {file.name: file.read_bytes() for file in Path().iterdir()}
    first = {name: content for name, content in written.items() if name.startswith("one")}
    assert len(first) == len(WRITING)
    for name, content in first.items():
        assert written[name.replace("one", "two")] == content, name


def test_several_files_appear_together_or_not_at_all(monkeypatch) -> None:
    Path("first").write_text("old")
    write = Path.write_bytes

    def fails(path: Path, data: bytes) -> int:
        written = write(path, data)
        if data == b"newer":
            raise OSError(28, "No space left on device")
        return written

    monkeypatch.setattr(Path, "write_bytes", fails)
    with pytest.raises(OSError, match="second: not written: No space left"):
        write_all([("first", "new"), ("second", "newer")])
    assert files() == {"first"}
    assert Path("first").read_text() == "old"


@pytest.mark.parametrize("old", ["old", None], ids=["a target", "no target"])
def test_a_link_stays_a_link_and_its_target_is_written(old) -> None:
    if old:
        Path("target").write_text(old)
    Path("link").symlink_to("target")
    write_all([("link", "new")])
    assert Path("link").is_symlink()
    assert Path("target").read_text() == "new"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("region minervabot-v2 --geojson a.json --json ./a.json", "two outputs"),
        ("region minervabot-v2 --json no/such/folder", "No such file or directory"),
        ("region minervabot-v2 --csv /dev/null", "no regular file"),
        ("region minervabot-v2 --csv a.csv --deviation 0", "above 0"),
        ("draw minervabot-v2 -o a.gif", "unknown ending '.gif'; wanted: .svg, .png"),
        ("region minervabot-v2 --svg x.pdf", "x.pdf: unknown ending '.pdf'; wanted: .svg"),
        ("region minervabot-v2 --json hand.toml", "unknown ending '.toml'; wanted: .json"),
        ("region minervabot-v2 --csv thesis.tex", "unknown ending '.tex'; wanted: .csv"),
        ("region minervabot-v2 --geojson a.svg", "unknown ending '.svg'; wanted: .geojson, .json"),
        ("region minervabot-v2 --npz a.npy", "unknown ending '.npy'; wanted: .npz"),
        ("workspace minervabot-v2 --svg a", "a: unknown ending ''; wanted: .svg"),
        ("certify minervabot-v2 -o thesis.tex", "unknown ending '.tex'; wanted: .json"),
        ("why minervabot-v2 0 0 1 1 -o hand.toml", "unknown ending '.toml'; wanted: .json"),
        ("explore minervabot-v2 -o hand.toml", "unknown ending '.toml'; wanted: .html, .htm"),
        ("import ur5.urdf -o thesis.tex", "unknown ending '.tex'; wanted: .toml"),
        ("allowed ur5 --srdf hand.toml", "unknown ending '.toml'; wanted: .srdf, .xml"),
        ("draw minervabot-v2 --component 5", "no component 5; there are 5, numbered from 0"),
        ("traverse minervabot-v2 1 7 --csv a.csv", "no vertex 7 in component 0: it has 6"),
        ("traverse minervabot-v2 -1 2", "no vertex -1"),
        ("traverse minervabot-v2 --arcs 1 --scale 0.5", "--scale and --arcs"),
        ("traverse minervabot-v2 1 2 --scale 0", "a scale is above 0"),
        ("traverse minervabot-v2 1 2 --deviation 0", "above 0"),
        ("certify minervabot-v2 --box q1=30deg:20deg q2=0:1", "--box q1=30deg..20deg: the low end"),
        ("certify minervabot-v2 --box q1=1..2..3 q2=0", "wanted LOW..HIGH, found 1..2..3"),
        ("certify minervabot-v2 --box q1=0 q1=1 q2=0", "--box q1=1: 'q1' has a range twice"),
        ("workspace minervabot-v2 --at 1e308,0 --svg a.svg", "1e+100 at most"),
        ("traverse minervabot-v2 1 2 --scale 1e300", "a scale is above 0, 1e+100 at most"),
        ("contains minervabot-v2 0 0 --weights 1e300 1", "1e+100 at most"),
        ("certify minervabot-v2 --scale 1/2", "--scale: '1/2' is no decimal number"),
        ("certify minervabot-v2 --scale nan", "--scale: 'nan' is no decimal number"),
        ("certify minervabot-v2 --margin -1", "margin"),
        ("certify minervabot-v2 --box q1=-20:30", "q2"),
        ("certify minervabot-v2 --inset 1", "inset"),
        ("certify minervabot-v2 --region --inset 0", "inset"),
        ("certify minervabot-v2 --largest-scale --margin 1", "--largest-scale"),
        ("certify pp-portal --region --inset 1e-9", "corners: ask for a larger one"),
        (
            "certify minervabot-v2 --region --inset 30",
            "30 cm is larger than home's margin to B3, 7.83",
        ),
        ("check cert.json --source", "--source"),
        ("check", "--source"),
        ("explore minervabot-v2 -o a.html --slice q1=1deg", "two joints"),
        ("region no-such-robot", "no-such-robot"),
        ("region minervabot-v2 --slice q9=1", "no joint 'q9'"),
        ("contains minervabot-v2 0", "1 value for 2 joints"),
        ("contains minervabot-v2 1e17 0", "q1: 1e17: an angle of 1e+06 rad at most is wanted"),
        ("contains minervabot-v2 0 0 --weights 0 1", "weights"),
        ("robots show nobody", "no robot 'nobody'"),
        ("robots show", "show: name one of"),
        ("region minervabot-v2 --slice q1=1 --slice q2=1", "every joint is held"),
        ("region ur5 --slice elbow_joint=1", "5 that are not held (shoulder_pan_joint, "),
        ("workspace minervabot-v2 --slice q1=0", "1 that are not held (q2)"),
        ("fibre two-links-on-a-table shoulder", "cspace region"),
        ("allowed two-links-on-a-table", "cspace region"),
        ("fly", "cspace: no command 'fly'; cspace --help lists them"),
        (
            "regoin minervabot-v2",
            "no command 'regoin': did you mean region? cspace --help lists them",
        ),
        (
            "why minervabot-v2 10mm 0 0 0",
            "q1: '10mm' is no value, such as 20deg or 0.35rad: it is a length, and this joint turns",
        ),
        (
            "contains pp-portal 20deg 0",
            "beam: '20deg' is no value, such as 0.2, a plain number of mm, or 20cm: it is an angle, and this joint slides",
        ),
        ("", "required"),
        ("workspace minervabot-v2 --go=-10deg,-20deg", "--go: expected 2 arguments"),
        ("workspace minervabot-v2 --at 3,high", "a place is two finite lengths"),
        ("workspace minervabot-v2 --at nan,1", "finite"),
        ("workspace minervabot-v2 --go 0 0,0", "2 joint values are needed"),
        ("workspace minervabot-v2 --go 0,0 0,x", "'x' is no value"),
        # what would take all memory says what it costs
        ("region minervabot-v2 --csv a.csv --deviation 1e-13", "points where 131072 are the most"),
        ("traverse minervabot-v2 1 2 --deviation 1e-12 --csv a.csv", "points where 1048576 are"),
        (
            "traverse minervabot-v2 --arcs 1 --deviation 1e-13 --csv a.csv",
            "points where 131072 are",
        ),
        ("traverse minervabot-v2 1 2 --scale 1e10", "cspace: "),
        # an empty word is an error, not an option left out
        *(
            (f"{line} ''", "an empty value")
            for line in (
                "claims",
                "region",
                "region minervabot-v2 --json",
                "region minervabot-v2 --slice",
                "certify minervabot-v2 --scale",
                "draw minervabot-v2 -o",
            )
        ),
        ("''", "an empty value where a command is wanted"),
        ("traverse minervabot-v2 1 2 --csv=", "an empty value"),
    ],
)
def test_bad_input_is_one_sentence_status_2_and_no_file(capsys, line, words) -> None:
    status, out, err = run(capsys, line)
    assert (status, out) == (2, "")
    assert words in err
    assert "Traceback" not in err
    assert "held=" not in err  # a word of Python
    assert files() == set()


REPLACED = [
    *WRITING,
    "region minervabot-v2 --json {}.json",
    "region minervabot-v2 --csv {}.csv",
    "region minervabot-v2 --geojson {}.geojson",
    "contains minervabot-v2 0 0 --json {}.json",
    "traverse minervabot-v2 1 2 --csv {}.csv",
    "fibre minervabot-v2 q1 0 0 --json {}.json",
    "why minervabot-v2 0 0 0.1 0.1 -o {}.json",
    "certify minervabot-v2 --scale 0.9 -o {}.json",
    "explore minervabot-v2 -o {}.html",
    "allowed ur5 --srdf {}.srdf",
    "import ur5.urdf -o {}.toml",
]


@pytest.mark.parametrize("line", REPLACED)
def test_a_file_is_replaced_only_if_it_is_empty_or_cspace_made_it(capsys, line) -> None:
    """`--json thesis.json` wrote over the reader's own file."""
    file = Path(shlex.split(line.format("x"))[-1])
    for own in (
        b'{"title": "thesis"}',
        b"q1,q2\n1,2\n",
        b"<svg/>",
        b"\x89PNG",
        b"PK\3\4",
        b"cspace",
    ):
        file.write_bytes(own)
        status, out, err = run(capsys, line.format("x"))
        assert (status, out, file.read_bytes()) == (2, "", own)
        assert f"{file}: not replaced, because cspace did not make this file" in err
    file.write_bytes(b"")
    status = run(capsys, line.format("x"))[0]
    made = file.read_bytes()
    assert len(made) > 99
    assert run(capsys, line.format("x"))[0] == status != 2
    assert file.read_bytes() == made
    assert files() == {file.name}


def test_the_picture_without_a_name_replaces_no_file_of_another(capsys) -> None:
    Path("minervabot-v2.svg").write_text("<svg/>")
    status, _, err = run(capsys, "draw minervabot-v2")
    assert (status, "did not make this file" in err) == (2, True)
    assert Path("minervabot-v2.svg").read_text() == "<svg/>"


# --- pipes and Ctrl-C ----------------------------------------------------------------------------


def test_a_reader_that_leaves_is_no_error() -> None:
    """As in ``cspace region ... --json - | head``, which is gone when the output comes."""
    command = [sys.executable, "-m", "cspace", "region", "minervabot-v2", "--json", "-"]
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, check=False)
    os.close(writer)
    assert (done.returncode, done.stderr) == (141, b"")


# --- how files are written -----------------------------------------------------------------------


def test_a_file_that_is_replaced_keeps_its_permissions_and_a_new_one_has_the_usual() -> None:
    for mode in (0o600, 0o640, 0o755):
        Path("old").write_text("old")
        Path("old").chmod(mode)
        write_whole("old", b"new")
        assert Path("old").read_bytes() == b"new"
        assert Path("old").stat().st_mode & 0o777 == mode
    write_whole("new", b"")
    Path("usual").touch()
    assert Path("new").stat().st_mode == Path("usual").stat().st_mode


def test_no_draft_has_a_name_that_can_be_guessed(monkeypatch) -> None:
    """Not from the file's name nor from the process; each is made anew, never opened."""
    drafts = []
    touch = Path.touch

    def seen(path: Path, mode: int = 0o666, exist_ok: bool = True) -> None:
        drafts.append((path.name, exist_ok))
        touch(path, mode, exist_ok)

    monkeypatch.setattr(Path, "touch", seen)
    for _ in range(2):
        write_all([("a.json", "x"), ("b.json", "y")])
    names = {name for name, _ in drafts}
    assert len(names) == len(drafts) == 4
    assert not [name for name in names if str(os.getpid()) in name or "json" in name]
    assert not any(exist_ok for _, exist_ok in drafts)


def test_files_are_written_in_one_place_only() -> None:
    """Each package writes files in one module: no other one renames or opens to write."""
    writes = r"\.write_(text|bytes)\(|\.rename\(|os\.replace|\.replace\((path|target)\b|\.part\""
    packages = [Path(package.__file__).parent for package in (cspace, lizarraga2025)]
    found = {
        str(path.relative_to(package.parent))
        for package in packages
        for path in package.rglob("*.py")
        if re.search(writes, path.read_text("utf-8"))
    }
    assert found == {"cspace/files.py", "lizarraga2025/results.py"}


def test_links_in_a_circle_are_refused_as_robots_and_as_outputs(capsys) -> None:
    Path("one").symlink_to("two")
    Path("two").symlink_to("one")
    for line in ("region one", "region minervabot-v2 --json one", "check one"):
        status, out, err = run(capsys, line)
        assert status == 2
        assert "Traceback" not in out + err
    assert files() == {"one", "two"}
    assert Path("one").is_symlink()


def test_a_file_is_not_written_over_what_it_is_made_from(capsys, arm) -> None:
    Path("link.toml").symlink_to(arm)
    lines = (
        f"region {arm} --json {arm}",
        f"region {arm} --json link.toml",
        f"explore {arm} -o {arm}",
        f"traverse {arm} 1 2 --svg {arm}",
        f"contains {arm} 0 20 --json {arm}",
        f"workspace {arm} --json {arm}",
        f"certify {arm} -o {arm}",
        f"certify {arm} --path {arm} -o ./{arm}",
        f"connected {arm} 0 20 1 21 --json {arm}",
    )
    for line in lines:
        status, out, err = run(capsys, line)
        assert (status, out) == (2, "")
        assert "would be written over" in err
    assert Path(arm).read_text() == ARM


def test_a_long_name_is_written_as_it_is() -> None:
    name = "x" * 255  # the longest that file systems know
    write_whole(name, b"new")
    assert files() == {name}


def test_a_file_named_like_a_number_has_just_that_name(capsys) -> None:
    assert run(capsys, "region minervabot-v2 --json -5.json")[0] == 0
    assert files() == {"-5.json"}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everything")
def test_what_may_not_be_written_is_refused_before_any_work(capsys) -> None:
    Path("kept").write_text("old")
    Path("kept").chmod(0o444)
    status, _, err = run(capsys, "region minervabot-v2 --json kept")
    assert (status, "no permission" in err) == (2, True)
    assert Path("kept").read_text() == "old"


# --- the ends of a command -----------------------------------------------------------------------


def shell(line: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a line of the shell with `cspace` in it."""
    setting = {**os.environ, **environment}
    program = f"{shlex.quote(sys.executable)} -m cspace"
    script = line.replace("cspace", program)
    return subprocess.run(
        ["sh", "-c", script], capture_output=True, text=True, env=setting, check=False
    )


@pytest.mark.parametrize("command", ["region minervabot-v2", "--help"])
def test_a_closed_or_full_output_leaves_no_traceback(command) -> None:
    assert shell(f"cspace {command} | :").stderr == ""
    assert shell(f"cspace {command} 2>&-").returncode == 0
    closed = shell(f"cspace {command} >&-")
    assert closed.returncode == 0
    assert "Traceback" not in closed.stderr
    full = shell(f"cspace {command} > /dev/full")
    assert "Traceback" not in full.stderr
    assert "Exception" not in full.stderr


def test_content_for_a_closed_output_is_refused() -> None:
    done = shell("cspace region minervabot-v2 --json - >&-")
    assert (done.returncode, done.stderr) == (2, "cspace: -: standard output is closed\n")


def test_a_terminal_that_knows_ascii_only_shows_escapes(tmp_path) -> None:
    text = ARM.replace('name = "arm"', 'name = "Größe"').replace('"P"', '"Säule"')
    Path("arm.toml").write_text(text, encoding="utf-8")
    narrow = {"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0", "LC_ALL": "C"}
    done = shell("cspace contains arm.toml 0 20", **narrow)
    assert (done.returncode, done.stderr) == (0, "")
    assert r"S\xe4ule" in done.stdout


def test_a_fault_of_the_program_is_no_answer(capsys, monkeypatch) -> None:
    """Python's own status after a traceback, 1, would say infeasible."""

    def fails(*_, **__):
        raise RuntimeError("\x1b[31mnever")

    monkeypatch.setattr("cspace.cli.fibre.fibres", fails)
    status, out, err = run(capsys, "fibre minervabot-v2 q2")
    assert (status, out) == (2, "")
    assert r"RuntimeError: \x1b[31mnever" in err


def test_a_warning_is_one_line(capsys, monkeypatch) -> None:
    def warns(*_, **__):
        warnings.warn("two\nlines", stacklevel=2)
        raise ValueError("and an error")

    monkeypatch.setattr("cspace.cli.fibre.fibres", warns)
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        _, _, err = run(capsys, "fibre minervabot-v2 q2")
    assert err == "cspace: warning: two\\nlines\ncspace: and an error\n"


def test_ctrl_c_in_a_process_is_one_line_and_status_130() -> None:
    """Once it works, which the file that it writes first would not tell: it says so itself.

    A process in the background starts with the signal ignored; so the script takes it up.
    """
    script = (
        "import os, signal, sys; from cspace.arms import fibres; from cspace.cli import main;"
        "signal.signal(signal.SIGINT, signal.default_int_handler);"
        "fibres.fibres = lambda *_, **__: os.kill(os.getpid(), signal.SIGINT) or input();"
        "sys.exit(main(['fibre', 'minervabot-v2', 'q2', '--json', 'a.json']))"
    )
    command = [sys.executable, "-c", script]
    done = subprocess.run(
        command, capture_output=True, text=True, stdin=subprocess.PIPE, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "cspace: stopped\n")
    assert files() == set()


# --- work without bound --------------------------------------------------------------------------


def test_a_command_that_tells_nothing_shows_how_long_it_takes(capsys, monkeypatch) -> None:
    """None of `draw`, `workspace` or `contains` did: of an imported arm they take many seconds."""
    monkeypatch.setattr("cspace.cli.terminal.EVERY", 0.0005)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    status, _, err = run(capsys, "workspace two-links-on-a-table")
    assert status == 0
    assert "cspace workspace: 0 s" in err
    assert err.endswith("\r\033[K")


def write_many_joints() -> None:
    """A URDF of nine joints: a form of all of them has 3^9 coefficients."""
    shape = "<origin xyz='0 0 0.1'/><geometry><capsule radius='0.03' length='0.2'/></geometry>"
    links = [urdf.link(f"l{k}", f"<collision>{shape}</collision>") for k in range(10)]
    places = [f"<origin xyz='0.02 0 0.3'/><axis xyz='0 {k % 2} {1 - k % 2}'/>" for k in range(9)]
    joints = [
        urdf.joint(f"j{k}", f"l{k}", f"l{k + 1}", more=place) for k, place in enumerate(places)
    ]
    urdf.written(Path(), *links, *joints, name="nine.urdf")


def test_commands_about_many_joints_and_pairs_say_what_memory_they_take(capsys) -> None:
    """Of 14,400 pairs `contains` took 4.5 GB, `why` more than 7, and nobody was asked."""
    write_many_joints()
    assert run(capsys, "import nine.urdf --excess 5mm -o nine.toml")[0] == 0
    held = "--slice " + " ".join(f"j{k}=0" for k in range(2, 9))
    pose = "0 " * 9
    for line in (
        f"why nine.toml {pose} {pose}",
        *(f"{name} nine.toml {held}" for name in ("region", "workspace", "draw")),
        f"explore nine.toml -o x.html {held}",
        f"traverse nine.toml 1 2 {held}",
    ):
        status, out, err = run(capsys, f"{line} --memory 0.1")
        assert (status, out) == (2, ""), line
        assert re.search(r"this takes about \d+\.\d GB of memory, and --memory allows 0.1; ", err)
        assert re.search(r"allow it with --memory (\d+)", err)
    status, _, err = run(capsys, f"why nine.toml {pose} {pose}")
    assert (status, "--memory allows 2; keep fewer pairs apart" in err) == (2, True)
    assert run(capsys, f"fibre nine.toml j4 {pose}")[0] == 0  # by balls, not by forms
    assert run(capsys, f"contains nine.toml {pose} --memory 0.1")[0] == 0


def test_work_that_takes_more_memory_than_allowed_is_refused_before_it_begins(capsys) -> None:
    assert run(capsys, "region two-links-on-a-table")[0] == 0
    status, out, err = run(capsys, "region two-links-on-a-table --memory 1e-6")
    assert (status, out, "and --memory allows" in err) == (2, "", True)
    obstacles = "".join(
        f'[[obstacle]]\nname = "o{k}"\ndisc = {{ at = [{k}, 9], radius = 0.1 }}\n'
        for k in range(900)
    )
    Path("many.toml").write_text(robot_text("two-links-on-a-table")[0] + obstacles)
    status, out, err = run(capsys, "region many.toml")
    assert (status, out, "this takes about 2.2 GB" in err) == (2, "", True)


# --- sentences -----------------------------------------------------------------------------------


def test_certify_names_the_file_that_is_wrong(capsys, arm) -> None:
    for text in (ARM.replace("axis = [0, 0, 1]", "axis = [0, 0, 0]"), "a = ["):
        Path("bad.toml").write_text(text)
        status, _, err = run(capsys, "certify bad.toml")
        assert (status, err.startswith("cspace: bad.toml: ")) == (2, True)


def test_lengths_and_angles_are_taken_in_any_unit(capsys) -> None:
    plain, with_units = (
        run(capsys, f"contains rp-telescopic-boom {values}") for values in ("-60 1.5", "-60° 150cm")
    )
    assert plain == with_units
    assert run(capsys, "contains rp-telescopic-boom -60deg 1500mm") == plain


def test_every_file_that_is_written_is_named(capsys) -> None:
    assert "written: a.svg, a.csv" in run(capsys, "region minervabot-v2 --svg a.svg --csv a.csv")[1]
    assert run(capsys, "explore minervabot-v2 -o a.html")[1].endswith("\nwritten: a.html\n")
    Path("lengths.toml").write_text(SWEEP)
    for line in (
        "certify minervabot-v2 --scale 0.9 -o b.json",
        "certify minervabot-v2 --scale 0.9 -o c.json",
        "certify minervabot-v2 --largest-scale -o d.json",
        "why minervabot-v2 0 0 1deg 1deg -o e.json --json f.json --svg g.svg",
        "traverse minervabot-v2 1 2 --scale 0.5 --csv h.csv --json i.json",
        "sweep lengths.toml -o swept --workers 1",
        "draw minervabot-v2 -o k.svg",
        "import scara.urdf --excess 5cm -o n.toml",
    ):
        before = files()
        _, out, err = run(capsys, line)
        assert err == ""
        made = files() - before
        assert made
        assert {name for name in made if name not in out} == set(), line


def test_a_sweep_says_which_arm_is_best_and_where_its_lines_are(capsys) -> None:
    Path("lengths.toml").write_text(SWEEP)
    out = run(capsys, "sweep lengths.toml -o swept --workers 1")[1]
    assert re.search(r"region.area: \S+ to \S+, largest at joint.q2.origin.0 = 10\n", out)
    assert "a line for each arm is in swept/points.jsonl" in out


def test_margins_are_summed_up_by_pairs_of_links_unless_all_are_asked_for(capsys) -> None:
    pose = "0 -90 90 -90 -90 0"
    few, every = (run(capsys, f"contains ur5 {pose}{more}")[1] for more in ("", " --all"))
    assert len(few.splitlines()) < 20
    assert len(every.splitlines()) > 200
    assert "the nearest of 205 boundaries and limits; --all lists every one" in few
    assert "/" not in few  # links, no balls
    amounts = [float(line.split()[1]) for line in few.splitlines() if line.startswith("  margin")]
    assert amounts == sorted(amounts)
    folded = run(capsys, "contains ur5 0 -90 180 -90 -90 0")
    assert folded[0] == 1
    assert len(folded[1].splitlines()) < 20


def test_home_in_collision_is_told_with_what_it_violates(capsys, arm) -> None:
    """It was told that home is in no component, and not why."""
    Path("unsafe.toml").write_text(ARM.replace("a = 0, b = 20", "a = 150, b = 45"))
    for line in ("explore unsafe.toml -o x.html", "workspace unsafe.toml", "region unsafe.toml"):
        status, out, err = run(capsys, line)
        assert status == 1
        assert "home violates a.upper, margin -30 deg" in out + err
        assert "b.upper" not in err or "home violates b.upper, margin -5 cm" in out + err
    assert (
        "opens with an arm that is not feasible" in run(capsys, "explore unsafe.toml -o x.html")[2]
    )


def test_a_slice_beyond_a_limit_is_not_laid_on_home(capsys) -> None:
    """Home is at 90 deg; it is the slice that holds the elbow at 400 deg."""
    rest = "shoulder_pan_joint=0 wrist_1_joint=0 wrist_2_joint=0"
    status, out, _ = run(capsys, f"region ur5 --slice elbow_joint=400deg {rest}")
    assert status == 1
    said = "the slice holds elbow_joint = 400 deg, which violates elbow_joint.upper, margin -40 deg"
    assert said in out
    assert "home violates" not in out


def test_a_unit_stands_beside_every_number(capsys, arm) -> None:
    told = run(capsys, f"contains {arm} 0 20")[1]
    assert re.search(
        r"distance \S+ (deg|cm)$|distance \S+ \(weights: 1 a rad, 1 a cm\)$", told, re.MULTILINE
    )
    workspace = run(capsys, "workspace minervabot-v2 --at=-45,20")[1]
    assert re.search(r"^area \S+ cm\^2, \S+ cm\^2 of it", workspace)
    assert len(re.findall(r"image \S+ cm\^2$", workspace, re.MULTILINE)) == 2
    assert "at (-45, 20) cm: " in workspace


def test_rounding_is_no_margin(capsys) -> None:
    """Along arcs the arm touches: what is left of 0 is said to be 0, within the tolerance."""
    out = run(capsys, "traverse minervabot-v2 --arcs 1 2 3 4 5 6")[1]
    margins = re.findall(r"smallest margin of \w+: (\S+) cm( \(within \S+ cm\))?", out)
    assert len(margins) == 5
    assert all(value == "0" and within for value, within in margins if abs(float(value)) < 1e-9)
    assert [within for _, within in margins if within]
    out = run(capsys, "contains rp-telescopic-boom -35 1e-17")[1]
    assert "margin 0 m (within " in out
    assert "e-17" not in out.replace("slide = 1e-17 m", "")  # the value that was asked about


def test_a_table_with_a_huge_cell_is_refused_in_one_short_line(capsys) -> None:
    for cell in ("1" * 300_000, "9" * 100_000):
        Path("p.csv").write_text(f"0,0\n{cell},1\n")
        for option in ("--path", "--polygon"):
            status, out, err = run(capsys, f"certify minervabot-v2 {option} p.csv")
            assert (status, out) == (2, "")
            assert err.startswith("cspace: p.csv")
            assert err.count("\n") == 1
            assert len(err) < 3000


# --- files without end ----------------------------------------------------------------------------

ENDLESS = {
    "region {}": "{}: more than 10 MB",
    "certify minervabot-v2 --path {}": "{}: more than 10 MB",
    "certify minervabot-v2 --polygon {}": "{}: more than 10 MB",
    "sweep {} -o folder": "{}: more than 10 MB",
    "check {}": "not proved: the file has more than 4000000 bytes",
}


@pytest.mark.parametrize("file", ["/dev/zero", "long"])
@pytest.mark.parametrize("command", ENDLESS)
def test_a_file_is_not_read_beyond_its_largest_size(command, file, capsys):
    """/dev/zero took all the memory there is, and a file of 200 MB 5 GB."""
    if file == "long":
        Path("long").write_bytes(b"#" * 10_000_001)
    assert main(command.format(file).split()) == 2
    assert ENDLESS[command].format(file) in "".join(capsys.readouterr())


@pytest.mark.parametrize("words", ["import {}", "import ur5.urdf --srdf {}", "region {}"])
def test_a_urdf_is_not_read_beyond_its_largest_size(words, capsys):
    Path("endless.urdf").symlink_to("/dev/zero")
    output = "-o arm.toml" if words.startswith("import") else ""
    assert main([*words.format("endless.urdf").split(), *output.split()]) == 2
    assert "endless.urdf: more than 20 MB" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("more", "words", "said"),
    [
        ("", "", "2 links could be the last one: b, c; name it, or one that carries it (--to LINK)"),
        ("<limit velocity='3'/>", "--to b", "without limits; give them for the import (--limits JOINT=LOW..HIGH)"),
    ],
)  # fmt: skip
def test_an_import_names_the_option_that_helps(more, words, said, capsys) -> None:
    links = [urdf.link(name, urdf.BALL) for name in "abc"]
    joints = [urdf.joint(f"to {child}", "a", child, more=more) for child in "bc"]
    urdf.written(Path(), *links, *joints)
    status, _, err = run(capsys, f"import arm.urdf -o arm.toml {words}")
    assert status == 2
    assert said in err
