"""Robot files at random: whatever is in one, an answer or one sentence, and never a traceback."""

from __future__ import annotations

import random
import warnings
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from qbound.cli import main

# The folder and the captured output serve all examples; on a busy machine nothing is too slow.
UNCHECKED = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow]

PACKAGED = Path(__file__).parents[1] / "src/qbound/robots"
FILES = [file.read_text("utf-8") for file in sorted(PACKAGED.glob("*.toml"))]
LINES = [line for text in FILES for line in text.splitlines()]
TEXTS = [
    (PACKAGED / f"{name}.toml").read_text("utf-8")
    for name in ("minervabot-v2", "two-links-on-a-table")
]
VALUES = [
    "nan", "-inf", "1e400", "0", "-1", "1e-300", "9" * 400, "true", '""', '"q1"', '"\\u0000"',
    "[]", "[0, 0]", "[[0]]", "{}", "1979-05-27", "{ q1 = 0 }", "'''x", "\ufeff", "[0, 0, 0]", '"3"',
]  # fmt: skip


@st.composite
def mutated(draw) -> str:
    """A file of points or bodies; lines changed, doubled, dropped, moved, or from other files."""
    lines = draw(st.sampled_from(TEXTS)).splitlines()
    for _ in range(draw(st.integers(1, 4))):
        i = draw(st.integers(0, len(lines) - 1))
        key = lines[i].partition("=")[0]
        change = draw(st.integers(0, 5))
        if change == 0:
            lines[i] = f"{key}= {draw(st.sampled_from(VALUES))}"
        elif change == 1:
            del lines[i]
        elif change == 2:
            lines.insert(i, draw(st.sampled_from(LINES)))
        elif change == 3:
            lines[i] = draw(st.text(max_size=20))
        elif change == 4:
            number = draw(st.floats(allow_nan=False) | st.integers())
            lines[i] = f"{key}= {number}"
        else:
            random.Random(draw(st.integers())).shuffle(lines)
    return "\n".join(lines)


@pytest.mark.parametrize("command", ["contains {} 0 0", "region {}"])
@settings(max_examples=60, deadline=None, suppress_health_check=UNCHECKED)
@given(text=mutated())
def test_a_mutated_file_is_an_answer_or_one_sentence(command, text, tmp_path, capsys) -> None:
    file = tmp_path / "robot.toml"
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # a pair that is never a wall
        status = main(command.format(file).split())
    out, err = capsys.readouterr()
    assert status in (0, 1, 2)
    assert (status == 2) == (out == "") == (err != "")
    assert err == "" or err.count("\n") == 1
    assert err == "" or err.startswith("qbound: ")


@settings(max_examples=100, deadline=None, suppress_health_check=UNCHECKED)
@given(content=st.binary(max_size=300))
def test_any_bytes_are_refused_in_one_sentence(content, tmp_path, capsys) -> None:
    file = tmp_path / "robot.toml"
    file.write_bytes(content)
    assert main(["contains", str(file), "0", "0"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"qbound: {file}: ")
    assert err.count("\n") == 1
