# ruff: noqa: E501  (one table, a case a line)
"""Sweeps: exact values in chunks written once, the same bytes whoever computes, bad input named."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
import zarr
from jsonschema import Draft202012Validator
from numpy.testing import assert_array_equal

from qbound import find_region, load_robot
from qbound.arms.fibres import fibres
from qbound.cli import main
from qbound.design import varied, workspace_area
from qbound.figures.sweeps import sweep_picture
from qbound.model.schema import SENTENCES
from qbound.sweeps import measures
from qbound.sweeps import specification as grid
from qbound.sweeps.measures import OtherVersionError, measure_job, versions
from qbound.sweeps.run import connected, execute, run_jobs
from qbound.sweeps.specification import (
    MeasureName,
    SpecificationError,
    Study,
    json_schema,
    read_specification,
)
from qbound.sweeps.store import OtherSweepError

VARY = '{ number = "joint.q2.origin.0", from = 10, to = 20, count = 3 }'
CLEARANCE = '{ number = "boundary.B1.clearance", from = -0.1, to = 0.3, count = 3 }'

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
    { name = "floor", type = "half-space", point = "tip", normal = [0, 0, 1], offset = 0.0 },
]
""".replace("TURNS", 'type = "revolute", axis = [0, -1, 0]')


SLIDES = """
schema = 1
name = "A slide and a turn beside a post"
length_unit = "m"
angle_unit = "deg"
home = { lift = 0, slide = 0, b = 0 }
tool = "tip"
joint = [
    { name = "lift", parent = "base", frame = "1", axis = [0, 0, 1], limits = [-0.5, 0.5], SLIDES },
    { name = "slide", parent = "1", frame = "2", axis = [1, 0, 0], limits = [0, 0.5], SLIDES },
    { name = "b", parent = "2", frame = "3", axis = [0, 0, 1], limits = [-170, 170], TURNS },
]
point = [
    { name = "tip", frame = "3", at = [0.5, 0, 0] },
    { name = "post", frame = "base", at = [0, 0.5, 0], radius = 0.2 },
]
boundary = [{ name = "apart", type = "pair", points = ["tip", "post"] }]
""".replace("SLIDES", 'type = "prismatic", origin = [0, 0, 0]').replace(
    "TURNS", 'type = "revolute", origin = [0, 0, 0]'
)


def here(jobs):
    """A runner without processes."""
    return ((job, measure_job(job), "") for job in jobs)


def written(place: Path, *lines: str, robot: str = "minervabot-v2", measure: str = "") -> Path:
    """A specification; lines are TOML."""
    asked = measure or '"region.area", "region.components"'
    head = ["schema = 1", f"robot = {robot!r}", f"measure = [{asked}]"]
    place.write_text("\n".join([*head, *lines]), encoding="utf-8")
    return place


@pytest.fixture
def study(tmp_path) -> Study:
    """Nine arms in six chunks, three of them no robots: a clearance is not negative."""
    text = f"vary = [{CLEARANCE}, {VARY}]\nchunk = 2"
    return read_specification(written(tmp_path / "spec.toml", text))


def files(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


# --- what is found --------------------------------------------------------------------------------


def test_values_are_those_of_direct_calls_and_any_reader_of_zarr_finds_them(tmp_path):
    asked = '"region.area", "region.home.area", "region.components", "workspace.area"'
    spec = written(tmp_path / "s.toml", f"vary = [{CLEARANCE}, {VARY}]", measure=asked)
    found = execute(read_specification(spec), tmp_path / "out", here)
    group = zarr.open_group(tmp_path / "out" / "values.zarr", mode="r")
    robot = load_robot("minervabot-v2")
    for i, clearance in enumerate(np.linspace(-0.1, 0.3, 3)):
        for j, offset in enumerate(np.linspace(10, 20, 3)):
            if clearance < 0:
                assert all(math.isnan(found.values[name][i, j]) for name in found.values)
                assert "-0.1 is too small" in found.reasons[i, j] == str(group["reason"][i, j])
                continue
            numbers = {"boundary.B1.clearance": clearance, "joint.q2.origin.0": offset}
            region = find_region(varied(robot, numbers))
            assert group["region.area"][i, j] == region.area
            assert group["region.home.area"][i, j] == region.home.area
            assert group["region.components"][i, j] == len(region.components)
            assert group["workspace.area"][i, j] == workspace_area(region)
            assert str(group["reason"][i, j]) == ""
    assert_array_equal(group["vary.1"][:], [10, 15, 20])
    assert group["region.area"].attrs["unit"] == found.measure_unit("region.area") == "rad^2"
    assert [found.axis_unit(0), found.axis_unit(1)] == ["cm", "cm"]
    assert len(found.reasons) == 3
    assert not found.whole
    best = found.best("workspace.area")
    assert found.values["workspace.area"][best] == np.nanmax(found.values["workspace.area"])


def test_held_joints_and_home_are_in_the_units_of_the_file(tmp_path):
    (tmp_path / "arm.toml").write_text(THREE, encoding="utf-8")
    vary = '{ number = "held.a", from = 30, to = 60, count = 2 }'
    spec = written(
        tmp_path / "s.toml", f"vary = [{vary}]", robot="arm.toml", measure='"region.area"'
    )
    found = execute(read_specification(spec), tmp_path / "out", here)
    robot = load_robot(tmp_path / "arm.toml")
    wanted = [find_region(robot, {"a": math.radians(q)}).area for q in (30, 60)]
    assert found.values["region.area"].tolist() == wanted
    assert found.axis_unit(0) == "deg"
    low = THREE.replace("offset = 0.0", "offset = -0.1")  # else all areas are half of the plane
    (tmp_path / "arm.toml").write_text(low, encoding="utf-8")
    robot = load_robot(tmp_path / "arm.toml")
    held = written(
        tmp_path / "h.toml",
        "slice = { c = 45 }",
        'vary = [{ number = "point.tip.at.0", also = ["joint.c.origin.0"], from = 0.2, to = 0.3, '
        "count = 2 }]",
        robot="arm.toml",
        measure='"region.area"',
    )
    found = execute(read_specification(held), tmp_path / "held", here)
    arms = [varied(robot, {"point.tip.at.0": x, "joint.c.origin.0": x}) for x in (0.2, 0.3)]
    wanted = [find_region(arm, {"c": math.radians(45)}).area for arm in arms]
    assert found.values["region.area"].tolist() == wanted
    assert wanted[0] != wanted[1]


def test_pavings_bracket_the_exact_area(tmp_path):
    asked = '"paving.inner", "paving.outer", "region.area"'
    spec = written(tmp_path / "s.toml", f"vary = [{VARY}]\ntolerance = 0.3", measure=asked)
    found = execute(read_specification(spec), tmp_path / "out", here).values
    part = found["region.area"] / math.tau**2
    assert (found["paving.inner"] < part).all()
    assert (part < found["paving.outer"]).all()
    assert (found["paving.outer"] - found["paving.inner"] <= 0.3).all()


def test_fibres_are_those_of_direct_calls(tmp_path):
    (tmp_path / "arm.toml").write_text(SLIDES, encoding="utf-8")
    asked = '"fibre.length", "fibre.home.length"'
    vary = '{ number = "joint.slide.limits.1", from = 0.4, to = 0.6, count = 2 }'
    lines = (f"vary = [{vary}]", "fibre = 'b'")
    spec = written(tmp_path / "s.toml", *lines, robot="arm.toml", measure=asked)
    found = execute(read_specification(spec), tmp_path / "out", here)
    assert found.reasons == {}
    for k, high in enumerate((0.4, 0.6)):
        robot = varied(load_robot(tmp_path / "arm.toml"), {"joint.slide.limits.1": high})
        free = fibres(robot, "b", robot.home)
        wanted = [free.length[0], next(i for i in free[0] if i.low <= 0 <= i.high)]
        wanted[1] = wanted[1].high - wanted[1].low
        got = [found.values[name][k] for name in measures.MEASURES if name in found.values]
        assert got == wanted
        assert 0 < wanted[1] < wanted[0]
    units = [found.measure_unit(name) for name in found.values]
    assert units == ["rad", "rad"]


def test_home_has_no_free_length_where_it_is_not_safe_and_is_held_where_a_joint_is(tmp_path):
    """The tip on a half-turn above the floor: between 0 and 180 degrees, home at 90."""
    (tmp_path / "arm.toml").write_text(THREE, encoding="utf-8")
    row = '{ number = "home.c", from = 0, to = 90, count = 2 }'
    held = '{ number = "held.b", from = 0, to = 180, count = 2 }'
    asked = '"fibre.home.length", "fibre.length"'
    lines = (f"vary = [{row}, {held}]", "fibre = 'a'")
    spec = written(tmp_path / "s.toml", *lines, robot="arm.toml", measure=asked)
    found = execute(read_specification(spec), tmp_path / "out", here)
    assert np.allclose(found.values["fibre.length"], math.pi)
    down = replace(load_robot(tmp_path / "arm.toml"), home=np.array([-math.pi / 2, 0, 0]))
    assert measures.home_length(fibres(down, "a", down.home), down) == 0
    up = found.values["fibre.home.length"]
    assert np.allclose(up[0], [math.pi, 0])
    assert np.allclose(up[1, 0], math.pi)


def test_the_page_has_every_measure_and_a_specification_that_is_one(tmp_path):
    page = (Path(__file__).parents[1] / "book" / "sweep.md").read_text(encoding="utf-8")
    for name, measure in measures.MEASURES.items():
        assert f"* - `{name}`\n  - {measure.needs}\n" in page
    (tmp_path / "s.toml").write_text(page.split("```toml\n")[1].split("```")[0])
    keys = read_specification(tmp_path / "s.toml").specification.__struct_fields__
    said = [any(text in page for text in (f"`{k}`", f"\n{k} = ", f"[[{k}]]")) for k in keys]
    assert all(said)


def test_names_of_measures_are_those_of_the_table():
    assert set(MeasureName.__args__) == set(measures.MEASURES)


# --- bytes, once, whole ---------------------------------------------------------------------------


def test_the_order_of_chunks_leaves_the_bytes_alone(study, tmp_path):
    execute(study, tmp_path / "one", here)
    execute(study, tmp_path / "other", lambda jobs: here(list(jobs)[::-1]))
    assert files(tmp_path / "one") == files(tmp_path / "other")


def test_an_interrupted_sweep_goes_on_where_it_was_left(study, tmp_path):
    def interrupted(jobs):
        for k, outcome in enumerate(here(jobs)):
            if k == 2:
                raise KeyboardInterrupt
            yield outcome

    asked: list[grid.Chunk] = []

    def counting(jobs):
        for outcome in here(jobs):
            asked.append(outcome[0].chunk)
            yield outcome

    with pytest.raises(KeyboardInterrupt):
        execute(study, tmp_path / "out", interrupted)
    left = files(tmp_path / "out")
    assert "summary.json" not in left
    told = []
    execute(study, tmp_path / "out", counting, lambda *done: told.append(done))
    assert asked == list(grid.chunks(study.specification))[2:]
    assert told == [(k, 6) for k in range(2, 7)]
    whole = files(tmp_path / "out")
    assert left.items() <= whole.items()
    execute(study, tmp_path / "straight", here)
    assert whole == files(tmp_path / "straight")
    execute(study, tmp_path / "out", counting)  # nothing is left to do
    assert len(asked) == 4


def test_a_chunk_counts_when_every_array_has_it(study, tmp_path):
    execute(study, tmp_path / "out", here)
    whole = files(tmp_path / "out")
    gone = tmp_path / "out" / "values.zarr" / "region.area" / "c" / "1" / "0"
    gone.unlink()
    execute(study, tmp_path / "out", here)
    assert files(tmp_path / "out") == whole


def test_what_no_worker_survives_is_missing_and_asked_for_again(study, tmp_path):
    def deadly(jobs):
        for job, measured, why in here(jobs):
            yield (job, None, "died") if job.chunk == (1, 0) else (job, measured, why)

    found = execute(study, tmp_path / "out", deadly)
    assert found.missing == {(1, 0): "died"}
    assert not (tmp_path / "out" / "summary.json").exists()
    assert execute(study, tmp_path / "out", here).missing == {}
    execute(study, tmp_path / "straight", here)
    assert files(tmp_path / "out") == files(tmp_path / "straight")


def test_a_folder_of_something_else_is_refused_and_left_as_it_is(study, tmp_path):
    execute(study, tmp_path / "out", here)
    before = files(tmp_path / "out")
    other = replace(study, robot=replace(study.robot, tool="7"))
    with pytest.raises(OtherSweepError, match=r'another sweep \(robot.tool: "3" there, "7" here'):
        execute(other, tmp_path / "out", here)
    text = f"vary = [{CLEARANCE}, {VARY.replace('= 20', '= 21')}]\nchunk = 2"
    other = read_specification(written(tmp_path / "spec.toml", text))
    with pytest.raises(OtherSweepError, match=r"specification.vary.1.to: 20.0 there, 21.0 here"):
        execute(other, tmp_path / "out", here)
    assert files(tmp_path / "out") == before
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.txt").write_text("mine")
    for place in ("full", "spec.toml"):
        with pytest.raises(OtherSweepError):
            execute(study, tmp_path / place, here)
    assert files(tmp_path / "full") == {"thesis.txt": b"mine"}


def test_the_summary_says_what_was_swept_and_how_to_open_it(study, tmp_path, monkeypatch):
    execute(study, tmp_path / "out", here)
    content = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert content["schema"] == "qbound/sweep/1"
    assert content["shape"] == [3, 3]
    assert content["versions"] == versions()
    schema = resources.files("qbound") / "schemas" / "sweep-summary.schema.json"
    keeps = Draft202012Validator(json.loads(schema.read_text(encoding="utf-8")))
    keeps.check_schema(keeps.schema)
    keeps.validate(content)
    Draft202012Validator(json_schema()).validate(content["specification"])
    for broken in ({"shape": [3, 0]}, {"schema": "qbound/sweep/2"}, {"seed": 1}, {"measures": []}):
        assert not keeps.is_valid(content | broken)
    assert [len(content[key]) for key in ("vary", "measures", "not_measured")] == [2, 2, 3]
    monkeypatch.chdir(tmp_path / "out")
    namespace = {"zarr": zarr}
    exec(f"opened = {content['open']}", namespace)
    assert namespace["opened"].shape == (3, 3)


# --- faults of machines, faults of arms -----------------------------------------------------------


def test_what_hangs_on_the_machine_is_raised_and_a_fault_of_an_arm_is_named(
    study, tmp_path, monkeypatch
):
    job = grid.job(study, (1, 0))
    with pytest.raises(OtherVersionError, match=r"a worker has .*; wanted: qbound 0.0.1"):
        measure_job(replace(job, versions={"qbound": "0.0.1"}))

    def failing(error):
        def compute(arm):
            raise error

        one = replace(measures.MEASURES["region.area"], compute=compute)
        monkeypatch.setitem(measures.MEASURES, "region.area", one)

    for error in (MemoryError(), OSError("disk"), ImportError("flint")):
        failing(error)
        with pytest.raises(type(error)):
            measure_job(job)
    failing(ZeroDivisionError("by 0\x1b[2J"))
    measured = measure_job(job)
    assert math.isnan(measured.values[0][0])
    assert measured.values[0][1] > 0
    assert measured.reasons[0] == "region.area: ZeroDivisionError: by 0\\x1b[2J"


# --- specifications -------------------------------------------------------------------------------

ROW = '{{ number = "joint.q2.origin.0", from = {}, to = {}, count = {} }}'
GOOD = f"vary = [{VARY}]"
AREA = '"region.area"'

BAD = [
    ("vary = []", AREA, "vary: [] has length 0; wanted: a list of 1 to 6 tables"),
    ("", AREA, "'vary' is missing"),
    (f"{GOOD}\nworkers = 3", AREA, "unknown key 'workers'; allowed: schema, robot"),
    (GOOD.replace("origin.0", "origin.9"), AREA, "vary[0].number: joint.q2.origin.9"),
    (GOOD.replace("q2", "q9"), AREA, "no joint 'q9'; there are q1, q2"),
    (GOOD.replace("origin.0", "name"), AREA, "joint.q2.name: no number stands there"),
    (GOOD.replace("joint.q2.origin.0", "held.q9"), AREA, "no joint 'q9'"),
    (f"vary = [{ROW.format('nan', 2, 3)}]", AREA, "vary[0].from: nan is no finite number"),
    (f"vary = [{ROW.format(1, 'inf', 3)}]", AREA, "vary[0].to: inf is no finite number"),
    (f"vary = [{ROW.format(1, 1e200, 3)}]", AREA, "vary[0].to: 1e+200 is too large"),
    (f"vary = [{ROW.format(3, 2, 3)}]", AREA, "vary[0].to: 2 is not above 3"),
    (f"vary = [{ROW.format(1, 2, 1)}]", AREA, "vary[0].count: 1 value cannot be both"),
    (f"vary = [{ROW.format(1, 2, 0)}]", AREA, "vary[0].count: 0 is too small"),
    (f"vary = [{ROW.format(1, 2, 1.5)}]", AREA, "1.5 is not a whole number"),
    (f"vary = [{ROW.format(1, 2, 10**6)}, {CLEARANCE}]", AREA, "makes 3000000 arms"),
    (f"vary = [{VARY}, {VARY}]", AREA, "joint.q2.origin.0 is varied twice"),
    (f"vary = [{CLEARANCE.replace('0.3', '-0.05')}]", AREA, "neither end is a robot"),
    (f"{GOOD}\nslice = {{ q1 = 0 }}", AREA, "1 of 2 are not held (q2)"),
    (f"{GOOD}\nslice = {{ q1 = 0, q2 = 0 }}", AREA, "every joint is held"),
    (f"{GOOD}\nslice = {{ q1 = nan }}", AREA, "slice.q1: nan is no finite"),
    (f"{GOOD}\nslice = {{ q9 = 0 }}", AREA, "slice.q9: no joint 'q9'"),
    (f"{GOOD}\ntolerance = 1.0", AREA, "tolerance: 1.0 is too large; allowed: less"),
    (f"{GOOD}\nrule = 'papr'", AREA, "rule: 'papr' is unknown"),
    (f"{GOOD}\nrule = 'paper'", '"paving.inner"', "knows the clearance rule only"),
    (GOOD, '"region.volume"', "measure[0]: 'region.volume' is unknown"),
    (GOOD, " ", "measure: [] has length 0"),
    (GOOD, '"fibre.length"', "takes a joint that moves: set 'fibre' to one of"),
    (f"{GOOD}\nfibre = 'q9'", '"fibre.length"', "there is no joint 'q9'; q1, q2"),
    (f"{GOOD}\nfibre = 'q1'\nslice = {{ q1 = 0 }}", '"fibre.home.length"', "measure[0]: fibre.home.length takes 'fibre', and q1 is held"),
    (GOOD, f"{AREA}, {AREA}", "measure[1]: region.area is asked for twice"),
    ("vary = [", AREA, "not TOML"),
    ("vary = 1979-05-27", AREA, "vary: 1979-05-27 is not a list"),
]  # fmt: skip


@pytest.mark.parametrize(("lines", "measure", "says"), BAD)
def test_a_bad_specification_is_named_with_its_place_and_nothing_is_made(
    capsys, tmp_path, lines, measure, says
):
    spec = written(tmp_path / "bad.toml", lines, measure=measure)
    assert main(["sweep", str(spec), "-o", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"qbound: {spec}: ")
    assert says in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_robot_is_looked_for_beside_the_specification(tmp_path):
    spec = written(tmp_path / "s.toml", GOOD, robot="no.toml")
    with pytest.raises(SpecificationError, match=r"s.toml: robot: .*no.toml: No such file"):
        read_specification(spec)


def test_options_that_cannot_be_are_refused(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr("qbound.sweeps.run.PATIENCE", 0.2)
    spec, out = str(written(tmp_path / "s.toml", GOOD)), str(tmp_path / "out")
    for words, says in (
        (["--workers", "0"], "--workers 0: one or more"),
        (["--workers", "2", "--scheduler", "tcp://x:1"], "has workers of its own"),
        (["--scheduler", "tcp://127.0.0.1:9"], "no scheduler answers"),
        (["--scheduler", "nonsense://x"], "scheduler nonsense://x"),
        (["--svg", spec], "is read here"),
    ):
        assert main(["sweep", spec, "-o", out, *words]) == 2
        assert says in capsys.readouterr().err


def test_the_shipped_schema_is_that_of_the_classes_and_every_keyword_has_a_sentence():
    file = resources.files("qbound") / "schemas" / "sweep.schema.json"
    assert file.read_text("utf-8") == json.dumps(json_schema(), indent=2) + "\n"
    Draft202012Validator.check_schema(json_schema())
    assert any("<" in start for start in SENTENCES)


# --- pictures -------------------------------------------------------------------------------------


def test_two_numbers_make_a_picture_and_none_makes_none(study, tmp_path):
    two = execute(study, tmp_path / "two", here)
    assert sweep_picture(two).startswith(b"<?xml")
    row = ROW.replace("origin.0", "origin.1").format(0, 0, 1)
    still = written(tmp_path / "s.toml", f"vary = [{row}]", measure=AREA)
    none = execute(read_specification(still), tmp_path / "none", here)
    with pytest.raises(ValueError, match="one or two varied numbers; 0 vary"):
        sweep_picture(none)


# --- a scheduler and two processes ----------------------------------------------------------------


@pytest.fixture
def cluster(tmp_path) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """A scheduler, and two workers that nobody starts again."""
    from distributed import Client, LocalCluster

    alone = {"n_workers": 0, "host": "127.0.0.1", "dashboard_address": None, "processes": True}
    worker = [sys.executable, "-m", "dask", "worker", "--no-nanny", "--no-dashboard"]
    worker += ["--nthreads", "1", "--local-directory", str(tmp_path), "--memory-limit", "0"]
    processes = []
    with LocalCluster(**alone) as scheduler:
        address = scheduler.scheduler_address
        try:
            for _ in range(2):
                quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
                processes.append(subprocess.Popen([*worker, address], **quiet))
            with Client(address, set_as_default=False) as client:
                client.wait_for_workers(2)
            yield address, processes
        finally:
            for process in processes:
                process.kill()
                process.wait()


def test_the_bytes_do_not_depend_on_workers_nor_on_one_that_is_killed(
    study, tmp_path, cluster, capsys
):
    address, processes = cluster
    execute(study, tmp_path / "none", here)
    wanted = files(tmp_path / "none")
    spec = str(tmp_path / "spec.toml")
    assert main(["sweep", spec, "-o", str(tmp_path / "two"), "--scheduler", address]) == 1
    assert "3 arms without a value" in capsys.readouterr().out
    assert files(tmp_path / "two") == wanted

    def kill(done: int, total: int) -> None:
        if done == 1:
            processes[0].kill()
            processes[0].wait()

    found = execute(study, tmp_path / "killed", lambda jobs: run_jobs(jobs, address, 1), kill)
    assert processes[0].returncode != 0
    assert found.missing == {}
    assert files(tmp_path / "killed") == wanted
    with connected(address, 1) as client:
        assert len(client.scheduler_info()["workers"]) == 1
    assert main(["sweep", spec, "-o", str(tmp_path / "one"), "--scheduler", address]) == 1
    assert files(tmp_path / "one") == wanted


def test_two_sweeps_at_one_time_take_ports_of_their_own():
    with connected(None, 1) as one, connected(None, 1) as other:
        places = [client.cluster.scheduler.http_server.port for client in (one, other)]
        assert 8787 not in places
        assert len({*places}) == 2
