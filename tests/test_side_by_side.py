"""The comparison with other tools: the same scenes for all, and verdicts that follow from times."""

import json
import os
from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from lizarraga2025.measured import VERDICTS, side_by_side
from qbound import find_region, load_robot
from qbound.boundary.evaluator import evaluator
from support.scripts import ROOT, importable

HERE = ROOT / "benchmarks" / "side_by_side"
COMMITTED = ROOT / "benchmarks" / "side_by_side.json"
MODULES = (
    "asking",
    "goals",
    "jobs",
    "packing",
    "plan",
    "scenes",
    "kinematics",
    "python_fcl",
    "serve",
)
MODULES += ("shapely_points", "typed", "streams_plan", "limits")


@pytest.fixture(scope="module")
def bench() -> Iterator[SimpleNamespace]:
    """The modules of the comparison, by name; nothing of them stays."""
    benchmarks = ROOT / "benchmarks"  # the scenes come with modules from there
    with importable(benchmarks), importable(HERE), importable(HERE / "peers"):
        yield SimpleNamespace(**{name: import_module(name) for name in MODULES})


# --- scenes ---------------------------------------------------------------------------------------


def test_the_region_between_the_walls_has_the_area_that_others_know(bench: Any) -> None:
    region = find_region(bench.scenes.robot("walls"))
    assert region.area == pytest.approx(bench.scenes.WALLS_AREA, abs=1e-5)
    assert len(region.components) == 1


@pytest.mark.parametrize("scene", ["paper", "walls", "boundaries-30", "ur5"])
def test_plain_numbers_are_the_robot(bench: Any, scene: str) -> None:
    """Balls and walls of the plain numbers judge as the evaluator does, by another kinematics."""
    told, q = bench.scenes.plain(scene), bench.scenes.configurations(scene, 2000, 1)
    told = json.loads(json.dumps(told))
    names = [point["name"] for point in told["points"]]
    radius = {point["name"]: point["radius"] for point in told["points"]}
    at = dict(zip(names, bench.kinematics.places(told, names, q).transpose(1, 0, 2), strict=True))
    safe = np.ones(len(q), dtype=bool)
    for pair in told["pairs"]:
        one, other = pair["points"]
        assert radius[one] + radius[other] == pytest.approx(pair["distance"], abs=1e-12)
        safe &= np.linalg.norm(at[one] - at[other], axis=1) >= pair["distance"]
    for wall in told["walls"]:
        safe &= at[wall["point"]] @ np.array(wall["normal"]) >= wall["level"]
    assert 0 < safe.sum() < len(q)
    assert safe.tolist() == evaluator(bench.scenes.robot(scene)).feasible(q).tolist()


def test_obstacles_are_told_with_their_shapes(bench: Any) -> None:
    told = bench.scenes.plain("obstacles10")
    assert len(told["obstacles"]) == 10
    assert {kind for body in told["obstacles"] for kind in ("disc", "polygon") if kind in body} == {
        "disc",
        "polygon",
    }
    assert [len(body["capsule"]) for body in told["bodies"]] == [2, 2]


def test_a_scene_without_balls_for_its_pairs_is_refused(bench: Any) -> None:
    robot = load_robot("minervabot-v2")
    pairs = [b for b in robot.used if len(getattr(b, "points", ())) == 2]
    apart = replace(pairs[0], clearance=5)
    with pytest.raises(ValueError, match="no balls stand"):
        bench.scenes.ball_radii(robot, [pairs[0], apart])


# --- peers ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", ["paper", "walls"])
def test_what_was_typed_by_hand_is_the_closed_form(bench: Any, scene: str) -> None:
    q = bench.scenes.configurations(scene, 20_000, 2)
    ours = evaluator(bench.scenes.robot(scene)).feasible(q)
    assert bench.typed.TYPED[scene](q).tolist() == ours.tolist()


@pytest.mark.parametrize("scene", ["paper", "walls", "ur5"])
def test_python_fcl_is_given_the_same_scene(bench: Any, scene: str) -> None:
    pytest.importorskip("fcl")
    q = bench.scenes.configurations(scene, 300, 3)
    ours = evaluator(bench.scenes.robot(scene)).feasible(q)
    assert bench.python_fcl.feasible(scene)(q).tolist() == ours.tolist()


def test_shapely_is_given_the_region_in_one_turn(bench: Any) -> None:
    pytest.importorskip("shapely")
    q = bench.scenes.configurations("paper", 5000, 4)
    ours = evaluator(bench.scenes.robot("paper")).feasible(q)
    assert (bench.shapely_points.many("paper")(q) != ours).sum() <= 5  # beside the arcs


def test_the_limits_sines_are_right(bench: Any) -> None:
    x = np.random.default_rng(5).uniform(-7, 7, 2000)
    sine, cosine = bench.limits.sine_cosine(x)
    assert np.abs(sine - np.sin(x)).max() < 1e-15
    assert np.abs(cosine - np.cos(x)).max() < 1e-15


@pytest.mark.parametrize("count", [0, 1, 8, 1001])
def test_booleans_survive_the_line(bench: Any, count: int) -> None:
    judged = np.random.default_rng(count).random(count) < 0.5
    assert bench.packing.unpacked(bench.packing.bits(judged), count).tolist() == judged.tolist()


PEER = """
from serve import Missing, Refused, serve, timed

def answer(scene, how):
    print("a library talks")
    if how == "missing":
        raise Missing("no such part")
    if how == "refused":
        raise Refused("never")
    if how == "wrong":
        raise ZeroDivisionError("oh")
    if how == "gone":
        raise SystemExit(3)
    while how == "forever":
        pass
    return timed(lambda: {"count": len(scene)})

serve("a peer", {"json": "msgspec"}, {"answer": answer})
"""


def test_a_peer_answers_refuses_is_stopped_and_begins_anew(
    bench: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "some.py").write_text(PEER)
    monkeypatch.setattr(bench.asking, "PEERS", tmp_path)
    monkeypatch.setenv("PYTHONPATH", "")
    paths = os.pathsep.join(map(str, (HERE / "peers", HERE)))
    monkeypatch.setattr(
        bench.asking, "environment", lambda: {"PYTHONPATH": paths, "PYTHONNOUSERSITE": "1"}
    )
    peer = bench.asking.Peer("some")

    def ask(how: str, task: str = "answer", limit: float = 60) -> dict[str, Any]:
        return peer.ask({"task": task, "scene": "paper", "how": how}, limit)

    assert ask("well")["answer"] == {"count": 5}
    assert peer.about["peer"] == "a peer"
    assert "msgspec" in peer.about["versions"]
    assert ask("well", task="other") == {"missing": "no task other"}
    assert ask("missing") == {"missing": "no such part"}
    assert ask("refused") == {"refused": "never"}
    assert ask("wrong") == {"refused": "ZeroDivisionError: oh"}
    assert ask("forever", limit=0.1) == {"over": 0.1}
    assert ask("gone") == {"refused": "its process has ended"}
    assert ask("well")["answer"] == {"count": 5}
    peer.end()


def test_a_peer_that_is_not_installed_is_reported_so(bench: Any, tmp_path: Path) -> None:
    peer = bench.asking.Peer("no_such_peer")
    assert peer.ask({"task": "stream"}, 1) == {"missing": "there is no such program"}


def test_a_peer_tells_what_of_it_could_not_be_installed(
    bench: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench.serve.sys, "prefix", str(tmp_path))
    assert bench.serve.why_not(["drake"]) == ""
    (tmp_path / "not-installed.json").write_text('{"drake": "no wheel"}')
    assert bench.serve.why_not(["numpy"]) == ""
    assert bench.serve.why_not(["numpy", "drake"]) == "drake: not installed (no wheel)"


# --- jobs and goals -------------------------------------------------------------------------------


def test_every_measurement_has_an_id_of_its_own(bench: Any) -> None:
    ids = [job.id_of(peer) for job in bench.plan.JOBS for peer in job.peers]
    assert len(set(ids)) == len(ids)
    assert all((HERE / "peers" / f"{p}.py").exists() for job in bench.plan.JOBS for p in job.peers)


def test_answers_are_compared_with_ours(bench: Any) -> None:
    def answer(*free: int) -> dict[str, Any]:
        return {"count": len(free), "bits": bench.packing.bits(free)}

    answers = {"qbound_numpy": answer(1, 0, 1), "other": answer(1, 1, 0)}
    kept = bench.streams_plan.compared(answers)
    assert kept["qbound_numpy"] == {"count": 3, "free": 2}
    assert kept["other"] == {"count": 3, "free": 2, "different": 2, "first different": [1, 2]}


def measured(name: str, *rounds: float, **more: Any) -> dict[str, Any]:
    middle = sorted(rounds)[len(rounds) // 2] if rounds else None
    times = {"seconds": middle, "rounds": list(rounds), "processor": middle} if rounds else {}
    return {"id": name, "peer": name, **times, **more}


FAR, NEAR = ({"answer": {"all": {"distance": x}}} for x in (0.5, 0.001))


@pytest.mark.parametrize(
    ("theirs", "change", "ratio", "met"),
    [
        ([measured("b", 4.0, 8.0, 12.0)], {}, 4, True),  # the median of 4, 4 and 4
        ([measured("b", 4.0, 2.0, 12.0)], {"goal": 4.5}, 4, False),
        ([measured("b", 16.0)], {}, 8, True),  # other rounds: the ratio of the medians
        ([measured("b", 4.0, 8.0, 12.0)], {"sense": "at most"}, 4, False),
        ([measured("b", over=120.0)], {}, 60, True),  # at least sixty times
        ([measured("b", over=120.0)], {"goal": 100}, 60, None),
        ([measured("b", missing="not here")], {}, None, None),
        ([], {}, None, None),
        ([measured("b", 16.0, **NEAR)], {"reach": 0.01}, 8, True),
        ([measured("b", 16.0, **FAR)], {"reach": 0.01}, None, None),
        ([measured("b", 16.0)], {"theirs": None, "sense": "at most", "goal": 2}, None, True),
        ([measured("b", 16.0)], {"theirs": None, "sense": "at most", "goal": 1.9}, None, False),
    ],
)
def test_a_goal_is_met_missed_or_open(
    bench: Any, theirs: list[Any], change: dict[str, Any], ratio: float | None, met: bool | None
) -> None:
    chosen = {"ours": "a", "theirs": "b", "sense": "at least", "goal": 3} | change
    goal = bench.goals.Goal(id="g", part="p", text="t", **chosen)
    (found,) = bench.goals.judged([measured("a", 1.0, 2.0, 3.0), *theirs], [goal])
    assert (found["ratio"], found["met"]) == (ratio, met)
    assert (met is None) <= bool(found.get("why"))


def test_every_goal_names_measurements_that_are_planned(bench: Any) -> None:
    planned = {job.id_of(peer) for job in bench.plan.JOBS for peer in job.peers}
    plans = {name for name in bench.plan.PLANS if (HERE / f"{name}.py").exists()}
    if plans != set(bench.plan.PLANS):
        pytest.skip("some of the plans are not there")
    named = {name for goal in bench.goals.GOALS for name in (goal.ours, goal.theirs) if name}
    assert named <= planned


# --- the committed file ---------------------------------------------------------------------------


def test_the_committed_verdicts_follow_from_the_committed_times(bench: Any) -> None:
    """`run.py --judge` writes them again after a change of the goals."""
    told = json.loads(COMMITTED.read_text(encoding="utf-8"))
    assert told["goals"] == bench.goals.judged(told["measurements"])


def test_the_reader_hands_on_what_the_file_says() -> None:
    told, found = json.loads(COMMITTED.read_text(encoding="utf-8")), side_by_side()
    assert [each.id for each in found.measurements] == [each["id"] for each in told["measurements"]]
    assert all((each.seconds is None) == bool(each.why) for each in found.measurements)
    assert {goal["met"] for goal in found.goals} <= set(VERDICTS)
    for theirs, ours in found.ahead("stream"):
        assert ours.is_ours
        assert not theirs.is_ours
        assert (theirs.scene, theirs.label) == (ours.scene, ours.label)
        assert theirs.seconds < ours.seconds


def test_a_file_of_another_schema_is_refused(tmp_path: Path) -> None:
    for text in ("[]", '{"schema": "qbound/results/2"}'):
        file = tmp_path / "other.json"
        file.write_text(text)
        with pytest.raises(ValueError, match=r"other\.json: this is no qbound/side-by-side/1"):
            side_by_side(file)


def test_the_committed_file_names_no_place() -> None:
    text = COMMITTED.read_text(encoding="utf-8")
    assert str(Path.home()) not in text
    assert "/tmp/" not in text
