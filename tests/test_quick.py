"""`run.py quick`, the first trial of an installation: what it asks, and what it calls a success."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from support.scripts import load_script

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """run.py, which finds its environment ready."""
    script = load_script("run.py")
    monkeypatch.setattr(script, "prepare", lambda: None)
    monkeypatch.setattr(script, "one_arithmetic", dict)
    return script


def test_the_claims_are_those_about_table_6(
    run: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(run, "answer", lambda command, **_: asked.extend(command) or "a\nlast")
    assert run.try_claims() == "last"
    names = [word for word in asked if isinstance(word, str)]
    assert names[0] == "claims"
    assert names[-1] == "--recompute"
    table = [f"T-6.{row}" for row in range(1, 12)]
    assert {"T-6", *table} < set(names)
    assert sum(name.startswith("B-") for name in names) == 22


def write_results(run: ModuleType, change: float = 0) -> Any:
    """Stand for the execution of chapters: write the recorded results, one of them changed."""

    def answer(command: list[Any], **_: Any) -> str:
        chapters = [word for word in command if Path(word).suffix == ".ipynb"]
        for chapter in chapters:
            content = json.loads(chapter.read_text(encoding="utf-8"))
            for cell in content["cells"]:
                cell["execution_count"] = 1
            chapter.write_text(json.dumps(content), encoding="utf-8")
            name = f"{chapter.stem.partition('_')[2]}.json"
            results = json.loads((run.RESULTS / name).read_text(encoding="utf-8"))
            numbers = (one for one in results["results"] if isinstance(one["value"], float))
            next(numbers)["value"] += change
            text = json.dumps(results, indent=1, ensure_ascii=False) + "\n"
            chapter.with_name(name).write_text(text, encoding="utf-8")
        return ""

    return answer


def test_two_chapters_with_the_recorded_numbers_are_a_success(
    run: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "answer", write_results(run))
    assert len(run.TRIED) == 2
    assert run.try_chapters().endswith("numbers as recorded in results/")


def test_another_number_is_a_failure(run: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "answer", write_results(run, change=1e-6))
    with pytest.raises(run.Failed, match=r"theorem_2\.json differs"):
        run.try_chapters()


def test_a_cell_that_did_not_run_is_a_failure(
    run: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "answer", lambda _command, **_: "")
    with pytest.raises(run.Failed, match="cells did not run"):
        run.try_chapters()


def test_each_step_says_success_on_a_line(
    run: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("try_environment", "try_claims", "try_chapters"):
        monkeypatch.setattr(run, name, lambda name=name: f"found by {name}")
    assert run.main(["quick"]) == 0
    said = capsys.readouterr().out
    assert said.count("SUCCESS in 0 s: found by try_") == len(run.trials()) == 3
    assert "All 3 steps succeeded" in said


def test_the_first_failure_ends_the_trial_with_its_status_and_its_words(
    run: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    command = [shutil.which("python3") or "python3", "-c", "print('no'); raise SystemExit(3)"]
    monkeypatch.setattr(run, "try_environment", lambda: run.answer(command))
    monkeypatch.setattr(run, "environment", dict)
    assert run.main(["quick"]) == 3
    said = capsys.readouterr().out
    assert "FAILED: no" in said
    assert "SUCCESS" not in said
