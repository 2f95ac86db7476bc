"""What the solvers are asked in the comparison: the same scene for all, and our answers to it."""

import tomllib

import pytest

from qbound.model.robotfile import parse_robot, robot_table
from support.scripts import ROOT, importable

HERE = ROOT / "benchmarks" / "side_by_side"
with importable(HERE.parent), importable(HERE), importable(HERE / "peers"):
    import certified
    import goals
    import qbound_certificate
    import qbound_paving
    import scenes
    import solvers_plan
    from serve import Refused


def test_the_certificate_is_about_the_scene() -> None:
    """A certificate holds the text that the scene is read from."""
    file = parse_robot(tomllib.loads(certified.text_of("walls")))
    assert robot_table(file) == robot_table(scenes.robot("walls"))


def test_the_goals_ask_for_what_is_planned() -> None:
    planned = {job.id_of(peer) for job in solvers_plan.JOBS for peer in job.peers}
    asked = {name for goal in goals.GOALS if goal.part == "certified" for name in (goal.ours,)}
    asked |= {goal.theirs for goal in goals.GOALS if goal.part == "certified" and goal.theirs}
    assert asked <= planned
    assert len(asked) == 2


@pytest.mark.parametrize("scene", ["walls", "paper", "three"])
def test_our_pavings_leave_as_little_open_as_is_asked(scene: str) -> None:
    _, _, answer = qbound_paving.paving(scene, 0.2)
    assert answer["enough"]


def test_our_certificate_holds_most_of_the_region_and_nothing_beyond() -> None:
    _, _, answer = qbound_certificate.check("walls")
    found = certified.with_share("walls")({"ours": answer})["ours"]
    assert 0.9 < found["share"] < 1
    assert found["beyond"] < 1e-9
    assert "rings" not in found


def test_a_scene_without_a_certificate_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    text = certified.text_of("walls").replace("offset = -1.83", "offset = 1.0")
    monkeypatch.setattr(qbound_certificate, "text_of", lambda scene: text)
    with pytest.raises((Refused, ValueError)):
        qbound_certificate.certify("nowhere")
