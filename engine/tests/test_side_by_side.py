"""The comparison with other tools: the same scenes for all, and verdicts that follow from times."""

import json
import math
import os
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cspace import find_region, load_robot
from cspace.boundary.evaluator import evaluator
from cspace.model.robotfile import parse_robot, robot_table
from engine_support.scripts import ROOT, importable
from lizarraga2025.measured import VERDICTS, side_by_side

HERE = ROOT / "engine" / "benchmarks" / "side_by_side"
COMMITTED = ROOT / "engine" / "benchmarks" / "side_by_side.json"
MODULES = ("asking", "drake_polytopes", "goals", "judges", "limits", "outlines", "proofs")
MODULES += ("quality", "run", "scenes", "table")
WALLS_AREA = 3.21682
"""Of the region between the two walls, rad^2, as the literature on IRIS has it by grids."""
DRAWN = 1e-3


@pytest.fixture(scope="module")
def bench() -> Iterator[SimpleNamespace]:
    """The modules of the comparison, by name; nothing of them stays."""
    with importable(ROOT / "engine" / "benchmarks"), importable(HERE):
        yield SimpleNamespace(**{name: import_module(name) for name in MODULES})


# --- scenes and peers -----------------------------------------------------------------------------


def test_the_region_between_the_walls_has_the_area_that_others_know(bench: Any) -> None:
    region = find_region(bench.scenes.robot("walls"))
    assert region.area == pytest.approx(WALLS_AREA, abs=5e-6)
    assert len(region.components) == 1


@pytest.mark.parametrize("scene", ["paper", "walls", "hundred", "ur5"])
def test_balls_and_walls_are_the_robot(bench: Any, scene: str) -> None:
    """They judge as the evaluator does, by another kinematics."""
    robot, q = bench.scenes.robot(scene), bench.scenes.configurations(scene, 2000, 1)
    told = bench.scenes.balls(robot)
    at = dict(
        zip(
            told.radii, np.moveaxis(bench.judges.places(robot, [*told.radii], q), 1, 0), strict=True
        )
    )
    safe = np.ones(len(q), dtype=bool)
    for one, other in told.pairs:
        apart = np.linalg.norm(at[one] - at[other], axis=1)
        safe &= apart >= told.radii[one] + told.radii[other] - 1e-12
    for name, normal, level in told.walls:
        safe &= at[name] @ normal - told.radii[name] >= level - 1e-12
    assert 0 < safe.sum() < len(q)
    assert safe.tolist() == evaluator(robot).feasible(q).tolist()


def test_a_scene_without_balls_for_its_pairs_is_refused(bench: Any) -> None:
    robot = load_robot("minervabot-v2")
    pairs = [b for b in robot.used if len(getattr(b, "points", ())) == 2]
    twice = replace(robot, boundaries=(pairs[0], replace(pairs[0], name="again", clearance=5)))
    with pytest.raises(ValueError, match="no balls stand"):
        bench.scenes.balls(twice)


@pytest.mark.parametrize("scene", ["paper", "walls"])
def test_what_was_typed_by_hand_is_the_closed_form(bench: Any, scene: str) -> None:
    q = bench.scenes.configurations(scene, 20_000, 2)
    typed = [bench.judges.TYPED[scene](*row) for row in q.tolist()]
    assert typed == evaluator(bench.scenes.robot(scene)).feasible(q).tolist()


@pytest.mark.parametrize("task", ["stream", "one"])
@pytest.mark.parametrize(
    ("peer", "scene", "library", "wrong"),
    [
        ("python_fcl", "paper", "fcl", 0),
        ("python_fcl", "ur5", "fcl", 0),
        ("closed_form_numba", "walls", "numba", 0),
        ("shapely_points", "paper", "shapely", 3),  # beside the arcs
    ],
)
def test_peers_are_given_the_same_scene(
    bench: Any, peer: str, scene: str, library: str, wrong: int, task: str
) -> None:
    pytest.importorskip(library)
    ours = evaluator(bench.scenes.robot(scene)).feasible(bench.scenes.configurations(scene, 300))
    *_, answer = getattr(bench.judges, peer)(task, scene, 300)
    assert (answer["free"] != ours).sum() <= wrong


def test_the_limits_sines_are_right(bench: Any) -> None:
    x = np.random.default_rng(5).uniform(-7, 7, 2000)
    sine, cosine = bench.limits.sine_cosine(x)
    assert np.abs(sine - np.sin(x)).max() < 1e-15
    assert np.abs(cosine - np.cos(x)).max() < 1e-15


def test_our_paving_leaves_as_little_open_as_is_asked(bench: Any) -> None:
    *_, answer = bench.proofs.qbound_cells("paving", "walls", 0.2, 0.0)
    assert answer["undecided"] <= 0.2
    part = WALLS_AREA / (2 * 1.57) ** 2
    assert answer["inner"] <= part <= answer["inner"] + answer["undecided"]


def test_our_certificate_is_about_the_scene_and_most_of_its_region(bench: Any) -> None:
    robot = parse_robot(tomllib.loads(bench.proofs.text_of("walls")))
    assert robot_table(robot) == robot_table(bench.scenes.robot("walls"))
    for task in ("certify", "alone"):
        *_, answer = bench.proofs.qbound_certificate(task, "walls")
        own = bench.quality.compared("walls", {"ours": answer})["ours"]["own"]
        assert 0.9 < own["covered"] < 1
        assert own["beyond"] < 1e-9


# --- processes ------------------------------------------------------------------------------------


def peer(task: str, scene: str, how: str) -> tuple[float, float, Any]:
    """A peer that fails in every way."""
    if how == "missing":
        import no_such_library  # type: ignore[import-not-found] # noqa: F401
    if how == "wrong":
        raise ZeroDivisionError("oh")
    if how == "gone":
        os._exit(3)
    while how == "forever":
        pass
    return 1.0, 2.0, {"count": len(scene)}


def test_a_peer_answers_refuses_is_stopped_and_begins_anew(bench: Any) -> None:
    asked = bench.asking.Asked(peer)

    def ask(how: str, limit: float = 60) -> dict[str, Any]:
        answer: dict[str, Any] = asked.ask({"task": "any", "scene": "paper", "how": how}, limit)
        return answer

    assert ask("well") == {"seconds": 1.0, "processor": 2.0, "answer": {"count": 5}}
    assert ask("missing") == {"missing": "No module named 'no_such_library'"}
    assert ask("wrong") == {"refused": "ZeroDivisionError: oh"}
    assert ask("forever", limit=0.1) == {"over": 0.1}
    assert ask("gone") == {"refused": "its process has ended"}
    assert ask("well")["answer"] == {"count": 5}
    asked.end()


def test_the_table_names_what_is_missing(bench: Any) -> None:
    row = bench.table.THEIRS[-1]
    absent = [{"id": "a", "task": "paving", "scene": "paper", "label": "1", "peer": row.name}]
    lines = bench.run.table([absent[0] | {"missing": "No module named 'codac'"}])
    assert len([line for line in lines if line.endswith("| 0 of 0 |")]) == 11
    assert lines[-1].endswith("missing: No module named 'codac' |")


# --- quality --------------------------------------------------------------------------------------


def square(half: float) -> Any:
    shapely = pytest.importorskip("shapely")
    return shapely.box(-half, -half, half, half)


@pytest.mark.parametrize("scene", ["paper", "walls", "obstacles10"])
def test_the_exact_answer_is_as_good_as_it_is_drawn(bench: Any, scene: str) -> None:
    found = bench.quality.quality(scene, find_region(bench.scenes.robot(scene)).to_shapely(DRAWN))
    assert found["components"] == found["true_components"]
    assert 0.2 * DRAWN < found["distance"] <= DRAWN
    assert found["covered"] == pytest.approx(1, abs=1e-3)
    assert found["beyond"] < 1e-3


def test_a_small_square_is_measured_as_what_it_is(bench: Any) -> None:
    found = bench.quality.quality("walls", square(0.1))
    assert found["area"] == pytest.approx(0.04)
    assert found["covered"] == pytest.approx(0.04 / WALLS_AREA, rel=1e-5)
    assert (found["beyond"], found["components"]) == (0, 1)
    (region,) = bench.quality.true_region("walls")[1].geoms
    far = max(math.hypot(*np.maximum(np.abs(q) - 0.1, 0)) for q in region.exterior.coords)
    assert found["distance"] == pytest.approx(far, abs=1e-6)


def test_what_is_claimed_and_not_feasible_is_beyond(bench: Any) -> None:
    found = bench.quality.quality("walls", square(1.57))
    assert found["covered"] == pytest.approx(1)
    assert found["beyond"] == pytest.approx((2 * 1.57) ** 2 / WALLS_AREA - 1, rel=1e-6)


def test_nothing_answered_has_no_distance(bench: Any) -> None:
    found = bench.quality.quality("walls", square(0.1).difference(square(1)))
    assert (found["area"], found["covered"], found["components"]) == (0, 0, 0)
    assert found["distance"] is None


def test_rays_find_one_component_and_step_over_thin_obstacles(
    bench: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def found(scene: str, at: bool) -> dict[str, Any]:
        *_, answer = bench.outlines.rays("region", scene, 1e-2)
        of = answer["at"] if at else None
        quality: dict[str, Any] = bench.quality.quality(scene, answer["shape"], of)
        return quality

    walls = found("walls", at=False)
    assert 0 < walls["distance"] <= 0.1
    assert walls["area_error"] < 1e-2
    assert found("paper", at=True)["beyond"] > 0.5
    monkeypatch.setattr(bench.outlines, "STRIDE", 0.005)
    assert found("paper", at=True)["beyond"] < 1e-3


def test_verdicts_are_compared_with_ours(bench: Any) -> None:
    answers = {"qbound_numpy": {"free": np.array([1, 0, 1])}, "b": {"free": np.array([1, 1, 0])}}
    kept = bench.quality.compared("paper", answers)
    assert kept["qbound_numpy"] == {"count": 3, "free": 2}
    assert kept["b"] == {"count": 3, "free": 2, "different": 2, "first different": [1, 2]}


# --- jobs, goals and the committed file -----------------------------------------------------------


def test_every_measurement_has_an_id_of_its_own_and_every_peer_a_job(bench: Any) -> None:
    ids = [job.id_of(function) for job in bench.table.JOBS for function in job.functions]
    assert len(set(ids)) == len(ids)
    asked = {function for job in bench.table.JOBS for function in job.functions}
    assert asked == {row.function for row in bench.table.PEERS}
    assert len(bench.table.THEIRS) == 12


def measured(name: str, *rounds: float, **more: Any) -> dict[str, Any]:
    middle = sorted(rounds)[len(rounds) // 2] if rounds else None
    times = {"seconds": middle, "rounds": list(rounds)} if rounds else {}
    return {"id": name, "peer": name, **times, **more}


FAR, NEAR = ({"answer": {"all": {"distance": x}}} for x in (0.5, 0.001))


@pytest.mark.parametrize(
    ("theirs", "change", "ratio", "met"),
    [
        (measured("b", 4.0, 8.0, 12.0), {}, 4, True),  # the median of 4, 4 and 4
        (measured("b", 4.0, 2.0, 12.0), {"goal": 4.5}, 4, False),
        (measured("b", 16.0), {}, 8, True),  # other rounds: the ratio of the medians
        (measured("b", 4.0, 8.0, 12.0), {"sense": "at most"}, 4, False),
        (measured("b", over=120.0), {}, 60, True),  # at least sixty times
        (measured("b", over=120.0), {"goal": 100}, 60, None),
        (measured("b", missing="not here"), {}, None, None),
        (measured("b", 16.0, **NEAR), {"reach": 0.01}, 8, True),
        (measured("b", 16.0, **FAR), {"reach": 0.01}, None, None),
        (measured("b", 16.0), {"of": ["a", None], "sense": "at most", "goal": 2}, None, True),
        (measured("b", 16.0), {"of": ["a", None], "sense": "at most", "goal": 1.9}, None, False),
    ],
)
def test_a_goal_is_met_missed_or_open(
    bench: Any, theirs: Any, change: dict[str, Any], ratio: float | None, met: bool | None
) -> None:
    goal = {"id": "g", "of": ["a", "b"], "quantity": "seconds", "sense": "at least", "goal": 3}
    found = bench.goals.judged(goal | change, {"a": measured("a", 1.0, 2.0, 3.0), "b": theirs})
    assert (found["ratio"], found["met"]) == (ratio, met)
    assert (met is None) <= bool(found.get("why"))


def test_a_goal_stays_as_it_was_where_a_side_is_not_measured(bench: Any) -> None:
    goal = {"id": "g", "of": ["a", "b"], "met": True}
    assert bench.goals.judged(goal, {"a": measured("a", 1.0)}) is goal


def test_the_committed_verdicts_follow_from_the_committed_times(bench: Any) -> None:
    told = json.loads(COMMITTED.read_text(encoding="utf-8"))
    every = {m["id"]: m for m in told["measurements"] + told["retired"]["measurements"]}
    assert told["goals"] == [bench.goals.judged(goal, every) for goal in told["goals"]]
    planned = {job.id_of(function) for job in bench.table.JOBS for function in job.functions}
    assert {each["id"] for each in told["measurements"]} == planned
    assert not planned & {each["id"] for each in told["retired"]["measurements"]}


def test_the_reader_hands_on_what_the_file_says() -> None:
    told, found = json.loads(COMMITTED.read_text(encoding="utf-8")), side_by_side()
    rows = told["measurements"] + told["retired"]["measurements"]
    assert [each.id for each in found.measurements] == [each["id"] for each in rows]
    assert all((each.seconds is None) == bool(each.why) for each in found.measurements)
    assert all(each.measured for each in found.measurements)
    retired = {each["id"] for each in told["retired"]["measurements"]}
    assert {each.id for each in found.measurements if each.retired} == retired
    assert {goal["met"] for goal in found.goals} <= set(VERDICTS)


def test_a_file_of_another_schema_is_refused(tmp_path: Path) -> None:
    for text in ("[]", '{"schema": "qbound/results/2"}'):
        file = tmp_path / "other.json"
        file.write_text(text)
        with pytest.raises(ValueError, match=r"other\.json: this is no qbound/side-by-side/1"):
            side_by_side(file)
