"""No test waits a fixed time or hangs on the clock: a busy machine is slower, not wrong."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

ROOT = Path(__file__).resolve().parents[1]
TESTS = (ROOT / "tests", ROOT / "engine" / "tests")
CLOCKS = {"time", "monotonic", "perf_counter", "process_time", "thread_time"}
CLOCKS |= {f"{name}_ns" for name in CLOCKS}
WAITS = {"sleep", "wait_for_timeout"}
LIMITS = {"timeout", "deadline", "startup_timeout"}
HAVE_A_CEILING = {
    "engine/tests/engine_support/browser.py",
    "tests/live/readers.py",
}  # they give up on a page that hangs


def impatient(source: str) -> Iterator[str]:
    """Yield what in a program waits a fixed time, allows a fixed time, or reads a clock."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else ""
            name = node.func.id if isinstance(node.func, ast.Name) else name
            owner = ast.unparse(node.func).split(".")[0]
            if name in WAITS or (owner == "time" and name in CLOCKS):
                yield f"line {node.lineno}: {ast.unparse(node.func)}"
            for word in node.keywords:
                if word.arg in LIMITS and is_number(word.value):
                    yield f"line {node.lineno}: {word.arg}={ast.unparse(word.value)}"
        if isinstance(node, ast.ImportFrom) and node.module == "time":
            yield f"line {node.lineno}: {ast.unparse(node)}"


def is_number(node: ast.expr) -> bool:
    return any(isinstance(n, ast.Constant) and n.value is not None for n in ast.walk(node))


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("time.sleep(1)", True),
        ("page.wait_for_timeout(200)", True),
        ("subprocess.run(command, timeout=2 * 30)", True),
        ("assert time.perf_counter() - start < 1", True),
        ("from time import perf_counter", True),
        ("settings(deadline=None)", False),
        ("page.wait_for(timeout=PATIENCE)", False),
        ("arm.time(1)", False),
    ],
)
def test_an_impatient_line_is_found_and_a_patient_one_is_not(line: str, found: bool) -> None:
    assert bool(list(impatient(line))) == found


def test_no_test_is_impatient() -> None:
    found = [file for folder in TESTS for file in folder.rglob("*.py")]
    files = {file.relative_to(ROOT).as_posix(): file for file in found}
    for name in HAVE_A_CEILING:
        assert list(impatient(files.pop(name).read_text(encoding="utf-8")))
    assert len(files) > 50
    lines = {
        name: list(impatient(file.read_text(encoding="utf-8"))) for name, file in files.items()
    }
    assert {name: said for name, said in lines.items() if said} == {}


def test_no_script_of_a_test_waits_for_a_timer() -> None:
    scripts = [script for folder in TESTS for script in folder.rglob("test_*.js")]
    assert scripts
    for file in scripts:
        assert not re.search(r"setTimeout|setInterval", file.read_text(encoding="utf-8")), file.name


def test_no_example_is_too_slow_and_none_has_a_deadline() -> None:
    assert settings.default is not None
    assert settings.default.deadline is None
    assert HealthCheck.too_slow in settings.default.suppress_health_check
    own = re.compile(r"suppress_health_check=\[(.*?)\]")  # replaces the profile's
    for file in (file for folder in TESTS for file in folder.rglob("test_*.py")):
        lists = own.findall(file.read_text(encoding="utf-8"))
        assert all("too_slow" in names for names in lists if file.name != Path(__file__).name)
