"""Pages that run, in two browsers, without a network: from the file system and over http."""

from __future__ import annotations

import contextlib
import functools
import http.server
import json
import re
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from cspace import check as checker
from cspace.cli import main as cspace
from lizarraga2025 import recorded

ROOT = Path(__file__).resolve().parents[2]
CHAPTER = f"chapters/{recorded.file_stem('region')}.html"
SAID = "document.querySelector('.rerun-said').textContent"
AT_REST = "document.querySelector('.rerun-bar').dataset.state !== 'busy'"
EDIT, ALONE, ONWARD = 1, 2, 3
"""The buttons below a cell, in their order."""
GUESS = "guess = ...  # True or False"
LOADED = 'robot = load_robot("minervabot-v2")'
SHORTER = """from cspace.model.robotfile import parse_robot, robot_text
robot = parse_robot(robot_text("minervabot-v2")[0].replace("[25.0,", "[24.5,"))"""


def run_to_the_end(reader):
    reader.until(f"!({AT_REST})", 60)
    reader.until(AT_REST)
    return reader.evaluate(SAID)


def pictures(reader, cell):
    """The text of a cell's new pictures."""
    found = f"[...document.querySelectorAll('.rerun-output[data-cell=\"{cell}\"] img')]"
    return reader.evaluate(
        f"Promise.all({found}.map(async (i) => {{"
        " const c = document.createElement('canvas'); await i.decode();"
        " c.width = i.naturalWidth; c.height = i.naturalHeight;"
        " c.getContext('2d').drawImage(i, 0, 0); return c.toDataURL().length; }))"
    )


def cells(chapter):
    """A chapter's cells as the page has them: number in the notebook, and text."""
    notebook = ROOT / "notebooks" / f"{recorded.file_stem(chapter)}.ipynb"
    found = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    return {k: "".join(c["source"]) for k, c in enumerate(found) if c["cell_type"] == "code"}


def edit(reader, number, text):
    """Put a text in the place of a cell's code, as a reader does who types."""
    reader.evaluate("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    tap_tool(reader, number, EDIT)
    reader.evaluate(
        f"((e) => {{ e.value = {json.dumps(text)}; e.dispatchEvent(new Event('input')); }})"
        f"(document.querySelector('.rerun-code-{number} ~ .rerun-editor'))"
    )


def tap_tool(reader, number, tool):
    reader.tap(f".rerun-code-{number} ~ .rerun-tools .rerun-button:nth-child({tool})")


def test_file_url_and_chapter_7(reader, html, tmp_path):
    reader.open((html / "index.html").as_uri())
    chapter = reader.evaluate(f"document.querySelector('a[href=\"{CHAPTER}\"]').href")
    reader.open(chapter)
    assert not reader.evaluate(
        "performance.getEntriesByType('resource').some((e) => e.name.includes('_live/'))"
    )
    reader.tap(".rerun-start")
    said = run_to_the_end(reader)
    count = len([each for each in recorded.results() if each["chapter"] == "region"])
    assert said.startswith(f"{count} of {count} numbers agree with the printed ones"), said

    first = pictures(reader, 7)
    number = next(k for k, text in cells("region").items() if LOADED in text)
    edit(reader, number, cells("region")[number].replace(LOADED, SHORTER))
    assert reader.text(".rerun-changed .rerun-mark") == "changed"
    tap_tool(reader, number, ONWARD)
    run_to_the_end(reader)
    assert pictures(reader, 7) != first

    reader.open((html / "_static" / "rerun-check.html").as_uri())
    certificate = tmp_path / "certificate.json"
    robot, *poses = "two-links-on-a-table", "20deg", "30deg", "40deg", "60deg"
    assert cspace(["why", robot, *poses, "-o", str(certificate)]) == 1
    reader.give("#certificate", certificate)
    assert reader.until("document.getElementById('verdict').textContent") == "Refuted"
    assert "'forearm, post' is violated at 'shoulder' = 20 deg" in reader.text("#words")
    assert (reader.complaints, reader.requests) == ([], [])


def test_a_proved_certificate_is_proved_on_the_desk_too(reader, html, tmp_path):
    certificate = tmp_path / "certificate.json"
    assert cspace(["certify", "minervabot-v2", "--scale", "0.95", "-o", str(certificate)]) == 0
    said = subprocess.run(
        [sys.executable, "-I", checker.__file__, certificate],
        capture_output=True,
        text=True,
        check=False,
    )
    reader.open((html / "_static" / "rerun-check.html").as_uri())
    reader.give("#certificate", certificate)
    assert reader.until("document.getElementById('verdict').textContent") == "Proved"
    assert reader.text("#words").strip() == said.stdout.strip()
    assert "\nproved: at every configuration of the set" in said.stdout
    assert reader.text("#text") == Path(checker.__file__).read_text(encoding="utf-8")
    assert (reader.complaints, reader.requests) == ([], [])


def test_a_wrong_file_gets_the_checkers_own_sentence_and_no_markup(reader, html, tmp_path):
    reader.open((html / "_static" / "rerun-check.html").as_uri())
    wrong = tmp_path / "<img src=x onerror=alert(1)>.json"
    wrong.write_text('{"schema": "<b>7</b>"}', encoding="utf-8")
    reader.give("#certificate", wrong)
    assert reader.until("document.getElementById('verdict').textContent") == "Not proved"
    assert reader.text("#words").startswith("not proved: ")
    assert reader.evaluate("document.querySelectorAll('#answer img, #answer b').length") == 0
    assert re.fullmatch("[0-9a-f]{64}", reader.text("#hash"))


def test_an_arm_is_tried_and_an_error_names_its_line(reader, html):
    reader.open((html / "_static" / "rerun-try.html").as_uri())
    reader.tap("#run")
    reader.until("/feasible poses/.test(document.getElementById('said').textContent)")
    before = reader.evaluate("document.getElementById('shown').srcdoc")
    edit = (
        "(() => {{ const t = document.getElementById('text'); t.value = t.value.replace({}); }})()"
    )
    reader.evaluate(edit.format('"0.25", "0.2"'))
    reader.tap("#run")
    reader.until("/busy/.test(document.getElementById('said').dataset.kind)", 30)
    reader.until("/feasible poses/.test(document.getElementById('said').textContent)")
    assert reader.evaluate("document.getElementById('shown').srcdoc") != before
    reader.evaluate(edit.format('"[0, 0, 1] },", "[0, 0] },"'))
    reader.tap("#run")
    wrong = reader.until(
        "(/Line 9: .*/.exec(document.getElementById('said').textContent) ?? [''])[0]"
    )
    assert "a list of 3 numbers" in wrong


@contextlib.contextmanager
def served(folder):
    quiet = type("Quiet", (http.server.SimpleHTTPRequestHandler,), {"log_message": lambda *_: None})
    handler = functools.partial(quiet, directory=str(folder))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


def test_the_first_chapter_runs_over_http_after_a_stop_and_its_exercise_is_answered(reader, html):
    with served(html) as address:
        reader.open(f"{address}/chapters/{recorded.file_stem('introduction')}.html")
        reader.tap(".rerun-start")
        reader.until(f"!({AT_REST})", 60)
        reader.tap(".rerun-stop")
        reader.until(f"{SAID}.startsWith('Stopped')", 60)
        reader.tap(".rerun-start")
        assert "numbers agree" in run_to_the_end(reader)
        number = next(k for k, text in cells("introduction").items() if GUESS in text)
        heard = f"document.querySelector('.rerun-output[data-cell=\"{number}\"]').textContent"
        assert "Not filled in yet" in reader.evaluate(heard)
        for answer, reply in (("False", "Not yet."), ("True", "Right.")):
            edit(reader, number, cells("introduction")[number].replace(GUESS, f"guess = {answer}"))
            tap_tool(reader, number, ALONE)
            reader.until(f"{heard}.trim() === {json.dumps(reply)}", 120)
        assert (reader.complaints, reader.requests) == ([], [])


def test_stop_is_heard_in_the_moment_of_the_start(reader, html):
    """Before Python is asked for, while the chapter is still read."""
    reader.open((html / CHAPTER).as_uri())
    reader.until("!!document.querySelector('.rerun-start')", 60)
    for button in ("start", "stop"):
        reader.evaluate(f"document.querySelector('.rerun-{button}').click()")
    reader.until(f"{SAID}.startsWith('Stopped')", 60)
    assert reader.evaluate(AT_REST)


def test_a_chapter_runs_no_script_but_its_own_and_shows_nothing_from_elsewhere(reader, html):
    reader.open((html / CHAPTER).as_uri())
    reader.until("document.querySelectorAll('mjx-container, .rerun-start').length > 1", 60)
    assert (reader.complaints, reader.requests) == ([], [])
    reader.evaluate(
        "(() => { const s = document.createElement('script'); s.textContent = 'window.alien = 1';"
        " const i = document.createElement('img'); i.src = 'http://elsewhere.invalid/a.png';"
        " i.onerror = () => { window.refused = true; };"
        " document.body.append(s, i); })()"
    )
    reader.until("window.refused", 60)
    assert reader.evaluate("window.alien ?? null") is None


def test_what_a_page_asks_for_elsewhere_and_its_errors_are_seen(reader, tmp_path):
    page = tmp_path / "page.html"
    page.write_text(
        "<script>fetch('http://elsewhere.invalid/').catch(() => { window.failed = true; });"
        " setTimeout(() => { throw Error('broken'); })</script>",
        encoding="utf-8",
    )
    reader.open(page.as_uri())
    reader.until("window.failed", 60)
    assert reader.requests == ["http://elsewhere.invalid/"]
    assert any("broken" in each for each in reader.complaints)


@pytest.mark.parametrize("scripts", [True, False])
def test_without_the_files_a_chapter_has_no_button(html, tmp_path, scripts):
    from playwright.sync_api import sync_playwright

    from engine_support.browser import FLAGS, chromium

    copy = tmp_path / "book"
    for name in ("chapters", "_static"):
        (copy / name).mkdir(parents=True)
    for file in [html / CHAPTER, *(html / "_static").glob("rerun*"), html / "_static" / "book.css"]:
        (copy / file.relative_to(html)).write_bytes(file.read_bytes())
    empty = ROOT / "book" / "_static" / "rerun-files.js"
    (copy / "_static" / "rerun-files.js").write_bytes(empty.read_bytes())
    with sync_playwright() as run:
        browser = run.chromium.launch(executable_path=chromium(), args=FLAGS)
        page = browser.new_context(offline=True, java_script_enabled=scripts).new_page()
        page.goto((copy / CHAPTER).as_uri())
        assert page.locator(".rerun-bar, .rerun-button").count() == 0
        assert ("run.py live" in page.content()) == scripts
        browser.close()
