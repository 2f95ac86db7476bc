"""A robot file is read once: whoever needs its numbers again has them from the robot."""

import pickle
import sys
import tomllib
from dataclasses import replace

import pytest
from flint import fmpq

from qbound import load_robot
from qbound.arms.why import why
from qbound.model.robotfile import as_written, parse_robot, robot_text
from qbound.model.source import Source
from qbound.proofs.certificates import statements
from qbound.proofs.certificates.certify import Subject, certify


@pytest.fixture
def readers(monkeypatch):
    """The modules that parse TOML, one entry for each time."""
    found, loads = [], tomllib.loads

    def counted(*args, **options):
        found.append(sys._getframe(1).f_globals["__name__"])
        return loads(*args, **options)

    monkeypatch.setattr(tomllib, "loads", counted)
    return found


QUESTIONS = {
    "separated by a joint": [0.0, 2.3],
    "connected": [0.2, -0.5],
    "infeasible": [0.0, 3.0],
}


@pytest.mark.parametrize("goal", QUESTIONS.values(), ids=QUESTIONS)
def test_why_parses_its_file_once(readers, goal):
    found = why("minervabot-v2", [0.0, 0.0], goal)
    assert found.certificate is not None
    assert readers.count("qbound.model.source") == 1
    assert set(readers) == {"qbound.model.source", "qbound.check"}  # which shares nothing


def test_why_of_a_paving_parses_its_file_once(readers):
    found = why("minervabot-v2", [-2.6, 0.2], [1.6, -2.3])
    assert found.answer == "separated"
    assert readers.count("qbound.model.source") == 1


def test_certify_parses_its_text_once(readers):
    text, _ = robot_text("minervabot-v2")
    answer = certify(text, statements.box(["-10", "-10"], ["10", "10"]))
    assert answer.verdict == "proved"
    assert readers.count("qbound.model.source") == 1


def test_a_robot_that_was_read_is_certified_without_a_reader_of_its_own(readers):
    robot = load_robot("minervabot-v2")
    subject = Subject(robot)
    for size in ("10", "5"):
        answer = certify(subject, statements.box([f"-{size}"] * 2, [size] * 2))
        assert answer.verdict == "proved"
    assert readers.count("qbound.model.source") == 1
    assert subject.text == robot_text("minervabot-v2")[0]


def test_a_decimal_is_a_double_and_a_rational():
    source = Source.of_text("a = 0.1\nb = [1, 2.50]\nc = {d = 1e3}\ne = true")
    assert source.table == {"a": 0.1, "b": [1, 2.5], "c": {"d": 1000.0}, "e": True}
    assert {type(x) for x in (source.table["a"], source.table["c"]["d"])} == {float}
    exact = {"a": fmpq(1, 10), "b": [1, fmpq(5, 2)], "c": {"d": fmpq(1000)}, "e": True}
    assert source.exact == exact


def test_a_source_goes_with_its_robot_into_another_process():
    robot = load_robot("minervabot-v2")
    again = pickle.loads(pickle.dumps(robot))
    assert again == robot
    assert again.source.text == robot.source.text
    assert again.source.exact == robot.source.exact


def test_a_robot_that_was_changed_is_written_anew():
    robot = load_robot("pp-portal")
    assert as_written(robot) is robot
    other = replace(robot, name="another portal")
    assert as_written(other) == other
    assert as_written(other).source.text != robot.source.text
    assert parse_robot(as_written(other).source.text) == other
