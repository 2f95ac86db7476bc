"""Files of the command: whole or not at all, several together or none, the same bytes twice."""

from __future__ import annotations

import csv
import io
import json
import shlex
import struct
import subprocess
import sys
from importlib import resources
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from jsonschema import Draft202012Validator, validate
from numpy.testing import assert_allclose
from shapely.geometry import Polygon, shape

from qbound import find_region, load_robot
from qbound.cli import command_parsers, main
from qbound.cli.files import write_all
from support.oracles import packaged_table, point_seen_from

MINERVA = load_robot("minervabot-v2")
ARM = """
schema = 1
name = "arm"
length_unit = "cm"
angle_unit = "deg"
home = { a = 0, b = 20 }
tool = "t"
[[joint]]
name = "a"
type = "revolute"
parent = "0"
frame = "1"
origin = [0, 0, 0]
axis = [0, 0, 1]
limits = [-120, 120]
velocity = 90
[[joint]]
name = "b"
type = "prismatic"
parent = "1"
frame = "2"
origin = [0, 0, 0]
axis = [1, 0, 0]
limits = [10, 40]
velocity = 20
[[point]]
name = "t"
frame = "2"
at = [0, 0, 0]
[[point]]
name = "post"
frame = "0"
at = [-25, 0, 0]
[[boundary]]
name = "P"
type = "pair"
points = ["post", "t"]
clearance = 5
"""


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def arm() -> str:
    Path("arm.toml").write_text(ARM)
    return "arm.toml"


def run(capsys, line: str) -> tuple[int, str, str]:
    try:
        status = main(shlex.split(line))
    except SystemExit as stop:  # argparse
        status = stop.code
    out, err = capsys.readouterr()
    return status, out, err


def files() -> set[str]:
    return {path.name for path in Path().iterdir()}


def follows_schema(content, name) -> None:
    file = resources.files("qbound") / "schemas" / f"{name}.schema.json"
    schema = json.loads(file.read_text(encoding="utf-8"))
    Draft202012Validator.check_schema(schema)
    validate(content, schema, Draft202012Validator)


# --- help ----------------------------------------------------------------------------------------


EXAMPLES = [
    line.removeprefix("example: ")
    for parser in command_parsers().values()
    for line in (parser.epilog or "").splitlines()
    if line.startswith("example: ")
]


def test_every_help_ends_with_an_example() -> None:
    for name, parser in command_parsers().items():
        assert parser.format_help().rstrip().splitlines()[-1].startswith(f"example: qbound {name}")


@pytest.mark.parametrize("line", EXAMPLES)
def test_every_example_works(capsys, line) -> None:
    program, _, rest = line.partition(" ")
    assert program == "qbound"
    if rest.startswith("check "):
        run(capsys, "certify minervabot-v2 --scale 0.96 -o cert.json")  # its own example
    status, _, err = run(capsys, rest)
    assert status in (0, 1)
    assert err == ""


def test_the_module_is_the_command() -> None:
    """``python -m qbound`` prints what ``qbound`` prints, under its name."""
    command = [sys.executable, "-m", "qbound", "robots", "--help"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("usage: qbound robots")


# --- traverse ------------------------------------------------------------------------------------


def test_a_traversal_by_the_papers_numbers(capsys) -> None:
    line = "traverse minervabot-v2 1 2 3 4 5 6 --rule paper --scale 0.9 --closed --json -"
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
    assert content["duration"] is None


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


def test_the_csv_is_the_path_with_units_in_its_header(capsys, arm) -> None:
    status, _, _ = run(capsys, f"traverse {arm} 1 2 --csv path.csv")
    assert status in (0, 1)
    rows = list(csv.reader(io.StringIO(Path("path.csv").read_text())))
    assert rows[0] == ["t_s", "a_rad", "b_cm", "x_cm", "y_cm", "z_cm"]
    values = np.array(rows[1:], dtype=float)
    t, a, b, x, y, z = values.T
    assert t[0] == 0
    assert (np.diff(t) > 0).all()
    assert_allclose([x, y], [b * np.cos(a), b * np.sin(a)], atol=1e-9)
    assert_allclose(z, 0)
    assert (np.abs(np.diff(a) / np.diff(t)) <= np.pi / 2 + 1e-9).all()
    assert (np.abs(np.diff(b) / np.diff(t)) <= 20 + 1e-9).all()


def test_without_velocities_the_time_is_left_empty_and_ros_says_what_is_missing(capsys) -> None:
    order = "traverse minervabot-v2 1 2 --scale 0.9"
    assert run(capsys, f"{order} --csv path.csv")[0] == 0
    assert {row[0] for row in csv.reader(Path("path.csv").read_text().splitlines()[1:])} == {""}
    status, out, err = run(capsys, f"{order} --ros ros.json --csv second.csv")
    assert (status, out) == (2, "")
    assert "no `velocity` for q1, q2" in err
    assert "duration" in err
    assert files() == {"path.csv"}
    assert run(capsys, f"{order} --ros ros.json --duration 4")[0] == 0
    last = json.loads(Path("ros.json").read_text())["points"][-1]
    assert last["time_from_start"]["sec"] + last["time_from_start"]["nanosec"] * 1e-9 == (
        pytest.approx(4, abs=1e-6)
    )


def test_a_speed_scale_slows_all_joints(capsys, arm) -> None:
    def duration(options: str) -> float:
        return json.loads(run(capsys, f"traverse {arm} 1 2 --json - {options}")[1])["duration"]

    assert duration("--speed-scale 0.25") == pytest.approx(4 * duration(""))


# --- polygons of a region ------------------------------------------------------------------------


def test_polygons_in_three_formats_are_the_same(capsys) -> None:
    line = "region minervabot-v2 --csv p.csv --geojson p.json --npz p.npz --deviation 1e-4"
    assert run(capsys, line)[0] == 0
    features = json.loads(Path("p.json").read_text())["features"]
    components = find_region(MINERVA).components
    assert len(features) == len(components)
    for feature, component in zip(features, components, strict=True):
        told = feature["properties"]
        drawn = shape(feature["geometry"])
        assert drawn.is_valid
        assert told["area"] == component.area
        assert 0 < told["deviation"] <= 1e-4
        assert abs(drawn.area - component.area) <= told["deviation"] * drawn.length
        assert told["unit"] == ["rad", "rad"]
    assert [feature["properties"]["contains_home"] for feature in features] == [True] + [False] * 4
    with np.load("p.npz", allow_pickle=False) as arrays:
        points, start = arrays["points"], arrays["start"]
        rings = [points[a:b] for a, b in pairwise(start)]
        assert (arrays["ring"] == 0).all()
    for ring, feature in zip(rings, features, strict=True):
        assert Polygon(ring).equals(shape(feature["geometry"]))
    rows = list(csv.DictReader(io.StringIO(Path("p.csv").read_text())))
    assert_allclose([[float(r["q1_rad"]), float(r["q2_rad"])] for r in rows], points)
    assert [int(r["component"]) for r in rows] == [i for i, ring in enumerate(rings) for _ in ring]


# --- sample --------------------------------------------------------------------------------------


def test_a_sample_in_three_formats_is_the_same(capsys) -> None:
    line = "sample minervabot-v2 -n 500 --seed 3 --csv s.csv --npz s.npz --json -"
    status, out, err = run(capsys, line)
    content = json.loads(out)
    assert (status, err) == (0, "")
    follows_schema(content, "sample")
    drawn = content["configurations"]
    assert content["free"] == sum(drawn["free"])
    p = content["fraction_free"]
    assert content["standard_error"] == pytest.approx((p * (1 - p) / 500) ** 0.5)
    with np.load("s.npz", allow_pickle=False) as arrays:
        for name in ("q", "tool", "free"):
            assert_allclose(arrays[name], drawn[name])
    rows = list(csv.reader(io.StringIO(Path("s.csv").read_text())))
    assert rows[0] == ["q1_rad", "q2_rad", "x_cm", "y_cm", "z_cm", "free"]
    assert_allclose(np.array(rows[1:], dtype=float)[:, :2], drawn["q"])


def test_a_sample_agrees_with_the_exact_area(capsys) -> None:
    content = json.loads(run(capsys, "sample minervabot-v2 -n 20000 --seed 1 --json -")[1])
    exact = find_region(MINERVA).area / (2 * np.pi) ** 2
    assert content["fraction_free"] == pytest.approx(exact, abs=4 * content["standard_error"])


def test_batches_draw_what_one_call_draws(capsys, monkeypatch) -> None:
    line = "sample minervabot-v2 -n 1000 --seed 5 --json -"
    whole = run(capsys, line)[1]
    monkeypatch.setattr("qbound.sampling.BATCH", 7)
    assert run(capsys, line)[1] == whole


def test_progress_goes_to_a_terminal_only(capsys, monkeypatch) -> None:
    monkeypatch.setattr("qbound.sampling.BATCH", 10)
    monkeypatch.setattr("qbound.cli.progress.EVERY", 0.0)
    line = "sample minervabot-v2 -n 100 --seed 5"
    assert run(capsys, line)[2] == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert "sampling: 50 %" in run(capsys, line)[2]


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


def test_the_default_picture_is_named_for_the_robot(capsys, arm) -> None:
    assert run(capsys, f"draw {arm}") == (0, "arm.svg\n", "")
    root = ElementTree.fromstring(Path("arm.svg").read_text())
    assert root.tag.endswith("svg")


def test_three_joints_are_drawn_with_one_held(capsys) -> None:
    third = """
[[joint]]
name = "c"
type = "revolute"
parent = "2"
frame = "3"
origin = [0, 0, 0]
axis = [0, 0, 1]
[[point]]
name = "u"
frame = "3"
at = [5, 0, 0]
"""
    text = ARM.replace("b = 20 }", "b = 20, c = 0 }").replace('tool = "t"', 'tool = "u"')
    Path("three.toml").write_text(text + third)
    status, _, err = run(capsys, "draw three.toml")
    assert status == 2
    assert "3 that are not held" in err
    assert run(capsys, "draw three.toml --slice c=30deg")[0] == 0
    status, out, _ = run(capsys, "traverse three.toml 1 2 --slice c=30deg --json -")
    content = json.loads(out)
    follows_schema(content, "traverse")
    assert status in (0, 1)
    assert all(stop["q"][2] == pytest.approx(np.pi / 6) for stop in content["stops"])


# --- the same bytes twice, whole or not at all ---------------------------------------------------


@pytest.mark.parametrize(
    "line",
    [
        "draw minervabot-v2 -o {}.svg",
        "draw minervabot-v2 -o {}.png",
        "region minervabot-v2 --npz {}.npz",
        "region minervabot-v2 --svg {}.svg",
        "sample minervabot-v2 -n 50 --seed 1 --npz {}.npz",
        "traverse minervabot-v2 1 2 3 --scale 0.8 --svg {}.svg",
    ],
)
def test_a_second_run_writes_the_same_bytes(capsys, line) -> None:
    """The second in another process and under another file name."""
    assert run(capsys, line.format("one"))[0] == 0
    command = [sys.executable, "-m", "qbound", *shlex.split(line.format("two"))]
    subprocess.run(command, check=True, capture_output=True)
    (one,), (two,) = Path().glob("one.*"), Path().glob("two.*")
    assert one.read_bytes() == two.read_bytes()


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


def test_a_link_stays_a_link_and_its_target_is_written() -> None:
    Path("target").write_text("old")
    Path("link").symlink_to("target")
    write_all([("link", "new")])
    assert Path("link").is_symlink()
    assert Path("target").read_text() == "new"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("region minervabot-v2 --csv a --npz a", "two outputs"),
        ("region minervabot-v2 --csv a --npz ./a", "two outputs"),
        ("region minervabot-v2 --json no/such/folder", "No such file or directory"),
        ("region minervabot-v2 --csv .", "no regular file"),
        ("region minervabot-v2 --csv /dev/null", "no regular file"),
        ("region minervabot-v2 --csv a --deviation 0", "above 0"),
        ("region minervabot-v2 --csv a --deviation -1", "above 0"),
        ("draw minervabot-v2 -o a.gif", "unknown ending '.gif'; wanted: .svg, .png"),
        ("draw minervabot-v2 -o a", "unknown ending ''"),
        ("draw minervabot-v2 --q 1", "1 value for 2 joints"),
        ("draw minervabot-v2 --component 5", "no component 5; there are 5, numbered from 0"),
        ("traverse minervabot-v2 1 7 --csv a", "no vertex 7 in component 0: it has 6"),
        ("traverse minervabot-v2 0 1", "no vertex 0"),
        ("traverse minervabot-v2 -1 2", "no vertex -1"),
        ("traverse minervabot-v2 1", "two vertices"),
        ("traverse minervabot-v2 1 2.5", "invalid int value"),
        ("traverse minervabot-v2 1 2 --component 9", "no component 9"),
        ("traverse minervabot-v2 1 2 --component -1", "no component -1"),
        ("traverse minervabot-v2 --arcs 7", "no arc 7"),
        ("traverse minervabot-v2 --arcs 0", "no arc 0"),
        ("traverse minervabot-v2 --arcs 1 --scale 0.5", "--scale and --arcs"),
        ("traverse minervabot-v2 1 2 --scale 0", "a scale is above 0"),
        ("traverse minervabot-v2 1 2 --scale nan", "a scale is above 0"),
        ("traverse minervabot-v2 1 2 --deviation 0", "above 0"),
        ("traverse minervabot-v2 1 2 --speed-scale 2", "above 0, at most 1"),
        ("traverse minervabot-v2 1 2 --duration 0", "above 0 s"),
        ("traverse minervabot-v2 1 2 --duration 1 --speed-scale 0.5", "the one decides"),
        ("traverse minervabot-v2 1 2 --csv a --ros a --duration 1", "two outputs"),
        ("traverse nobody 1 2", "nobody"),
        ("sample minervabot-v2 -n 0 --seed 1", "one configuration or more"),
        ("sample minervabot-v2 -n 5 --seed -1", "0 or above"),
        ("sample minervabot-v2 -n 5", "--seed"),
        ("sample minervabot-v2 -n 5 --seed 1 --csv a --json a", "two outputs"),
    ],
)
def test_bad_input_is_one_sentence_status_2_and_no_file(capsys, line, words) -> None:
    status, out, err = run(capsys, line)
    assert (status, out) == (2, "")
    assert words in err
    assert "Traceback" not in err
    assert files() == set()


# --- pipes and Ctrl-C ----------------------------------------------------------------------------


def test_a_reader_that_leaves_is_no_error() -> None:
    """As in ``qbound region ... --json - | head``, which is gone when the output comes."""
    command = [sys.executable, "-m", "qbound", "region", "minervabot-v2", "--json", "-"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 141


def test_ctrl_c_ends_without_a_traceback_and_without_a_file(capsys, monkeypatch) -> None:
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("qbound.sampling.sample", interrupt)
    status, out, err = run(capsys, "sample minervabot-v2 -n 5 --seed 1 --csv a")
    assert (status, out, err) == (130, "", "qbound: stopped\n")
    assert files() == set()


@pytest.mark.parametrize(
    "words",
    [["sample", "-n", "99999999999999", "--seed", "1"], ["traverse", "1", "2", "--scale", "1e10"]],
)
def test_what_does_not_fit_into_memory_is_one_sentence(words, capsys):
    command, *options = words
    assert main([command, "minervabot-v2", *options]) == 2
    assert capsys.readouterr().err.startswith("qbound: ")
