# ruff: noqa: E501  (one table, a case a line)
"""Sweeps: exact values, a line an arm, the same bytes whoever computes, bad input named."""

from __future__ import annotations

import json
import math
import os
import pty
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from importlib import resources
from pathlib import Path
from threading import Event

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from cspace import find_region, load_robot, sweeps
from cspace.cli import main
from cspace.design import varied, vary, workspace_area
from cspace.model.robotfile import robot_table
from cspace.sweeps import MEASURES, VERSIONS, MeasureName, SweepError, measured, sweep

VARY = '{ number = "joint.q2.origin.0", from = 10, to = 20, count = 3 }'
CLEARANCE = '{ number = "boundary.B1.clearance", from = -0.1, to = 0.3, count = 3 }'
BOTH = f"vary = [{CLEARANCE}, {VARY}]"
COUNT = 160
MANY = f"vary = [{VARY.replace('count = 3', f'count = {COUNT}')}]"

THREE = """
schema = 1
name = "Three joints over a floor"
length_unit = "m"
angle_unit = "deg"
home = { a = 90, b = 0, c = 0 }
tool = "tip"
joint = [
    { name = "a", parent = "base", frame = "1", origin = [0, 0, 0], TURNS },
    { name = "b", parent = "1", frame = "2", origin = [0.4, 0, 0], TURNS },
    { name = "c", parent = "2", frame = "3", origin = [0.3, 0, 0], TURNS },
]
point = [{ name = "tip", frame = "3", at = [0.2, 0, 0] }]
boundary = [
    { name = "floor", type = "half-space", point = "tip", normal = [0, 0, 1], offset = -0.1 },
]
""".replace("TURNS", 'type = "revolute", axis = [0, -1, 0]')


def written(place: Path, *lines: str, robot: str = "minervabot-v2", measure: str = "") -> str:
    """A specification; lines are TOML."""
    asked = measure or '"region.area", "region.components"'
    head = ["schema = 2", f"robot = {robot!r}", f"measure = [{asked}]"]
    place.write_text("\n".join([*head, *lines]), encoding="utf-8")
    return str(place)


def alone(work, todo, address, workers):
    """No processes: every arm is measured in this one."""
    return ((index, work(index)) for index in todo)


@pytest.fixture
def here(monkeypatch) -> None:
    monkeypatch.setattr(sweeps, "on_dask", alone)


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def points(folder: Path) -> list[dict]:
    return [json.loads(line) for line in (folder / "points.jsonl").read_text().splitlines()]


# --- what is found --------------------------------------------------------------------------------


@pytest.mark.usefixtures("here")
def test_values_are_those_of_direct_calls_and_an_arm_that_cannot_be_built_is_recorded(tmp_path):
    """A clearance below 0 makes no arm; the others are measured."""
    spec = written(tmp_path / "s.toml", BOTH, measure=", ".join(f'"{name}"' for name in MEASURES))
    found = sweep(spec, tmp_path / "out")
    robot = load_robot("minervabot-v2")
    for point in points(tmp_path / "out"):
        clearance, offset = point["boundary.B1.clearance"], point["joint.q2.origin.0"]
        i, j = point["index"]
        assert clearance == np.linspace(-0.1, 0.3, 3)[i]
        assert offset == np.linspace(10, 20, 3)[j]
        if clearance < 0:
            assert all(point[name] is None for name in MEASURES)
            assert all(math.isnan(found.values[name][i, j]) for name in MEASURES)
            assert "-0.1 is too small" in point["reason"] == found.reasons[i, j]
            continue
        region = find_region(
            varied(robot, {"boundary.B1.clearance": clearance, "joint.q2.origin.0": offset})
        )
        assert point["region.area"] == found.values["region.area"][i, j] == region.area
        assert point["region.home.area"] == region.home_component.area
        assert point["region.components"] == len(region.components)
        assert point["workspace.area"] == workspace_area(region)
        assert point["reason"] == ""
    assert (len(found.reasons), found.missing) == (3, 0)
    assert found.axes["joint.q2.origin.0"].tolist() == [10, 15, 20]


@pytest.mark.usefixtures("here")
def test_held_joints_are_in_the_units_of_the_file_and_several_numbers_change_together(tmp_path):
    (tmp_path / "arm.toml").write_text(THREE, encoding="utf-8")
    robot = load_robot(tmp_path / "arm.toml")
    row = '{ number = "held.a", from = 30, to = 60, count = 2 }'
    told = {"robot": "arm.toml", "measure": '"region.area"'}
    found = sweep(written(tmp_path / "s.toml", f"vary = [{row}]", **told), tmp_path / "out")
    wanted = [find_region(robot, {"a": math.radians(q)}).area for q in (30, 60)]
    assert found.values["region.area"].tolist() == wanted
    pair = '{ number = "point.tip.at.0", also = ["joint.c.origin.0"], from = 0.2, to = 0.3, count = 2 }'
    spec = written(tmp_path / "h.toml", "slice = { c = 45 }", f"vary = [{pair}]", **told)
    found = sweep(spec, tmp_path / "held")
    numbers, held = ["point.tip.at.0", "joint.c.origin.0"], {"c": math.radians(45)}
    wanted = vary(robot, numbers, [0.2, 0.3], held=held).measures.tolist()
    assert found.values["region.area"].tolist() == wanted
    assert wanted[0] != wanted[1]


def test_vary_takes_several_numbers_each_with_values_of_its_own():
    robot, numbers = load_robot("minervabot-v2"), ["joint.q2.origin.0", "boundary.B1.clearance"]
    rows = [[10.0, 0.1], [10.0, 0.3], [20.0, 0.3]]
    found = vary(robot, numbers, rows, "workspace")
    arms = [varied(robot, dict(zip(numbers, row, strict=True))) for row in rows]
    assert found.measures.tolist() == [workspace_area(find_region(arm)) for arm in arms]
    assert found.best == rows[int(found.measures.argmax())]
    for wrong in ([[1.0]], [[1.0, 2.0, 3.0]], [[]], 1.0):
        with pytest.raises(ValueError, match="values in a row"):
            vary(robot, numbers, wrong)


@pytest.mark.usefixtures("here")
def test_a_sweep_is_a_dataset_where_xarray_is(tmp_path, monkeypatch):
    found = sweep(written(tmp_path / "s.toml", BOTH), tmp_path / "out")
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ModuleNotFoundError, match="pip install xarray"):
        found.to_xarray()
    monkeypatch.undo()
    pytest.importorskip("xarray")
    data = found.to_xarray()
    assert data["region.area"].dims == ("boundary.B1.clearance", "joint.q2.origin.0")
    assert float(data["region.area"][1, 2]) == found.values["region.area"][1, 2]


def test_a_fault_of_the_machine_is_raised_and_one_of_an_arm_is_named(monkeypatch, tmp_path):
    asked, robot = sweeps.read_specification(written(tmp_path / "s.toml", BOTH))
    table = robot_table(robot)

    def failing(error: Exception) -> None:
        def compute(region):
            raise error

        monkeypatch.setitem(MEASURES, "region.components", compute)

    with pytest.raises(RuntimeError, match=r"a worker has .*; wanted: .*0.0.1"):
        measured(asked, table, {"cspace": "0.0.1"}, (1, 0))
    for error in (MemoryError(), OSError("disk"), ImportError("flint")):
        failing(error)
        with pytest.raises(type(error)):
            measured(asked, table, VERSIONS, (1, 0))
    failing(ZeroDivisionError("by 0\x1b[2J"))
    point = json.loads(measured(asked, table, VERSIONS, (1, 0)))
    assert point["region.area"] > 0
    assert point["region.components"] is None
    assert point["reason"] == "ZeroDivisionError: by 0\\x1b[2J"


# --- the folder -----------------------------------------------------------------------------------


def test_an_interrupted_sweep_goes_on_and_a_half_written_line_is_dropped(tmp_path, monkeypatch):
    spec, asked = written(tmp_path / "s.toml", BOTH), []

    def interrupted(work, todo, *_):
        for index in todo[::-1]:  # in another order
            asked.append(index)
            yield index, work(index)
            if len(asked) == 4:
                raise KeyboardInterrupt

    monkeypatch.setattr(sweeps, "on_dask", interrupted)
    with pytest.raises(KeyboardInterrupt):
        sweep(spec, tmp_path / "out")
    left = (tmp_path / "out" / "points.jsonl").read_bytes()
    assert left.count(b"\n") == 4
    (tmp_path / "out" / "points.jsonl").write_bytes(left + left[:30])
    told = []
    sweep(spec, tmp_path / "out", progress=told.append)
    assert told == [5, 6, 7, 8, 9]
    assert len(set(asked)) == len(asked) == 9
    sweep(spec, tmp_path / "straight")
    assert files(tmp_path / "out") == files(tmp_path / "straight")
    sweep(spec, tmp_path / "out", progress=told.append)  # nothing is left to do
    assert len(told) == 5


@pytest.mark.usefixtures("here")
def test_a_folder_of_something_else_is_refused_and_left_as_it_is(tmp_path):
    spec, out = written(tmp_path / "s.toml", BOTH), tmp_path / "out"
    sweep(spec, out)
    before = files(out)
    written(tmp_path / "s.toml", BOTH.replace("to = 20", "to = 21"))
    with pytest.raises(
        SweepError, match=r"another sweep \(specification.vary.1.to: 20.0 there, 21.0 here"
    ):
        sweep(spec, out)
    assert files(out) == before
    written(tmp_path / "s.toml", BOTH)
    (out / "points.jsonl").write_bytes(before["points.jsonl"] + b'{"index": [9, 9]}\nmine')
    with pytest.raises(SweepError, match="line 10: is no arm of this sweep"):
        sweep(spec, out)
    assert (out / "points.jsonl").read_bytes().endswith(b"mine")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.txt").write_text("mine")
    for place in ("full", "s.toml"):
        with pytest.raises(SweepError, match="is no sweep"):
            sweep(spec, tmp_path / place)
    assert files(tmp_path / "full") == {"thesis.txt": b"mine"}


# --- specifications -------------------------------------------------------------------------------

ROW = '{{ number = "joint.q2.origin.0", from = {}, to = {}, count = {} }}'
GOOD = f"vary = [{VARY}]"
AREA = '"region.area"'

BAD = [
    ("vary = []", AREA, "vary: [] has length 0"),
    ("", AREA, "'vary' is missing"),
    (f"{GOOD}\nchunk = 1", AREA, "unknown key 'chunk'"),
    (GOOD.replace("origin.0", "origin.9"), AREA, "vary[0]: joint.q2.origin.9"),
    (GOOD.replace("joint.q2.origin.0", "held.q9"), AREA, "q9"),
    (f"vary = [{ROW.format('nan', 2, 3)}]", AREA, "vary[0].from: nan"),
    (f"vary = [{ROW.format(1, 1e200, 3)}]", AREA, "vary[0].to: 1e+200 is too large"),
    (f"vary = [{ROW.format(3, 2, 3)}]", AREA, "vary[0]: 3 from 3 to 2 do not rise"),
    (f"vary = [{ROW.format(1, 2, 0)}]", AREA, "vary[0].count: 0 is too small"),
    (f"vary = [{ROW.format(1, 2, 10**6)}, {CLEARANCE}]", AREA, "makes 3000000 arms; at most 1000000"),
    (f"vary = [{VARY}, {VARY}]", AREA, "joint.q2.origin.0 has two values"),
    (f"vary = [{CLEARANCE.replace('0.3', '-0.05')}]", AREA, "is too small; allowed: at least 0"),
    (f"{GOOD}\nslice = {{ q1 = 0 }}", AREA, "takes two joints, and 1 are not held"),
    (GOOD, '"region.volume"', "measure[0]: 'region.volume' is unknown; allowed: region.area"),
    ("vary = [", AREA, "not TOML"),
]  # fmt: skip


@pytest.mark.parametrize(("lines", "measure", "says"), BAD)
def test_a_bad_specification_is_named_with_its_place_and_nothing_is_made(
    capsys, tmp_path, lines, measure, says
):
    spec = written(tmp_path / "bad.toml", lines, measure=measure)
    assert main(["sweep", spec, "-o", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"cspace: {spec}: ")
    assert says in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_options_that_cannot_be_are_refused(capsys, tmp_path):
    spec, out = written(tmp_path / "s.toml", GOOD, robot="no.toml"), str(tmp_path / "out")
    assert main(["sweep", spec, "-o", out]) == 2
    assert "robot: " in (err := capsys.readouterr().err)
    assert "no.toml: No such file" in err
    written(tmp_path / "s.toml", GOOD)
    for words, says in (
        (["--workers", "-1"], "--workers -1: one or more"),
        (["--scheduler", "nonsense://x"], "unknown address scheme 'nonsense'"),
        (["--memory", "1e-6"], "take fewer workers"),
    ):
        assert main(["sweep", spec, "-o", out, *words]) == 2
        assert says in capsys.readouterr().err


def test_the_page_the_schema_and_the_table_of_measures_agree(tmp_path):
    page = (Path(__file__).parents[2] / "book" / "sweep.md").read_text(encoding="utf-8")
    assert set(MeasureName.__args__) == set(MEASURES)
    assert all(f"* - `{name}`\n" in page for name in MEASURES)
    (tmp_path / "s.toml").write_text(page.split("```toml\n")[1].split("```")[0])
    keys = sweeps.read_specification(tmp_path / "s.toml")[0].__struct_fields__
    assert all(any(t in page for t in (f"`{k}`", f"\n{k} = ", f"[[{k}]]")) for k in keys)
    file = resources.files("cspace") / "schemas" / "sweep.schema.json"
    assert file.read_text("utf-8") == json.dumps(sweeps.json_schema(), indent=2) + "\n"
    Draft202012Validator.check_schema(sweeps.json_schema())


# --- processes ------------------------------------------------------------------------------------


def some_lines(folder: Path, count: int, alive: Callable[[], bool]) -> None:
    """Wait until a sweep has written some lines."""
    file = folder / "points.jsonl"
    while not file.exists() or file.read_bytes().count(b"\n") < count:
        assert alive()
        Event().wait(0.05)


def test_ctrl_c_in_a_terminal_is_one_sentence_and_what_is_finished_stays(tmp_path):
    spec, out = written(tmp_path / "s.toml", MANY), tmp_path / "out"
    main_end, terminal = pty.openpty()
    line = [sys.executable, "-m", "cspace", "sweep", spec, "-o", str(out), "--workers", "2"]
    process = subprocess.Popen(
        line, stdin=terminal, stdout=terminal, stderr=terminal, start_new_session=True
    )
    os.close(terminal)
    some_lines(out, 3, lambda: process.poll() is None)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does, to the workers too
    said = b""
    while True:
        try:
            part = os.read(main_end, 4096)
        except OSError:  # nobody writes any more
            break
        said += part
    os.close(main_end)
    assert process.wait(60) == 130
    assert said.replace(b"\r", b"").endswith(b"cspace: stopped\n")
    assert b"Traceback" not in said
    assert 3 <= len(points(out)) < COUNT


@pytest.fixture
def cluster(tmp_path) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """A scheduler, and two workers that nobody starts again."""
    from distributed import Client, LocalCluster

    alone = {"n_workers": 0, "host": "127.0.0.1", "dashboard_address": None, "processes": True}
    worker = [sys.executable, "-m", "dask", "worker", "--no-nanny", "--no-dashboard"]
    worker += ["--nthreads", "1", "--local-directory", str(tmp_path), "--memory-limit", "0"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with LocalCluster(**alone) as scheduler:
        address = scheduler.scheduler_address
        processes = [subprocess.Popen([*worker, address], **quiet) for _ in range(2)]
        try:
            with Client(address, set_as_default=False) as client:
                client.wait_for_workers(2)
            yield address, processes
        finally:
            for process in processes:
                process.kill()
                process.wait()


def test_a_cluster_at_an_address_gives_the_same_bytes_also_if_a_worker_is_killed(
    tmp_path, cluster, capsys
):
    address, processes = cluster
    spec = written(tmp_path / "s.toml", BOTH)
    assert main(["sweep", spec, "-o", str(tmp_path / "two"), "--scheduler", address]) == 1
    assert "3 arms without a value" in capsys.readouterr().out

    def kill(done: int) -> None:
        if done == 1:
            processes[0].kill()
            processes[0].wait()

    found = sweep(spec, tmp_path / "killed", address, progress=kill)
    assert processes[0].returncode != 0
    assert found.missing == 0
    assert files(tmp_path / "killed") == files(tmp_path / "two")
