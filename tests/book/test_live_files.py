"""What puts Python beside the book: files by their hash, scripts, licences; needs no browser."""

from __future__ import annotations

import base64
import gzip
import hashlib
import io
import json
import re
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest

from engine_support.scripts import load_script
from lizarraga2025 import recorded

ROOT = Path(__file__).resolve().parents[2]
LIVE = ROOT / "tools" / "live"
LOCK = tomllib.loads((LIVE / "files.toml").read_text(encoding="utf-8"))
PARTS = {each["part"] for each in LOCK["file"]}


@pytest.fixture(scope="module", autouse=True)
def beside():
    """The scripts of tools/live import each other, as Python runs them."""
    sys.path.insert(0, str(LIVE))
    yield
    sys.path.remove(str(LIVE))


@pytest.fixture
def fetch(monkeypatch):
    """The script, with a lock of one file and no client to call."""
    script = load_script(LIVE / "fetch.py")
    file = {"name": "engine.wasm", "sha256": SHA, "part": "engine", "from": ["npm engine@1"]}
    monkeypatch.setattr(script, "wanted", lambda: [file])
    monkeypatch.setattr(script, "in_package", lambda carrier, scratch: iter(()))
    return script


CONTENT = b"the right bytes"
SHA = "a3580425cdf75097ce23009719cdfc5122bb108be11c1eee8aeca7dc8a027204"


def folder_with(place, kind):
    place.mkdir()
    if kind == "plain":
        (place / "engine.wasm").write_bytes(CONTENT)
    elif kind == "wheel":
        with zipfile.ZipFile(place / "carrier-1-py3-none-any.whl", "w") as archive:
            archive.writestr("somewhere/engine.wasm", CONTENT)
    else:
        with tarfile.open(place / "engine-1.tgz", "w:gz") as archive:
            entry = tarfile.TarInfo("package/engine.wasm")
            entry.size = len(CONTENT)
            archive.addfile(entry, io.BytesIO(CONTENT))
    return place


@pytest.mark.parametrize("kind", ["plain", "wheel", "archive"])
def test_a_file_is_taken_from_a_folder_or_from_an_archive_in_it(fetch, tmp_path, kind):
    target = tmp_path / "target"
    fetch.fetch(target, [folder_with(tmp_path / "folder", kind)])
    assert [each.name for each in target.iterdir()] == ["engine.wasm"]
    assert (target / "engine.wasm").read_bytes() == CONTENT


def test_a_file_with_another_hash_is_refused_wherever_it_comes_from(fetch, tmp_path):
    folder = folder_with(tmp_path / "folder", "plain")
    (folder / "engine.wasm").write_bytes(b"other bytes")
    with pytest.raises(fetch.Missing, match=r"No carrier has .*engine\.wasm"):
        fetch.fetch(tmp_path / "target", [folder])
    assert list((tmp_path / "target").iterdir()) == []


def test_every_file_of_the_lock_has_a_hash_a_licence_and_a_part_that_pages_know():
    script = (ROOT / "book" / "_static" / "rerun.js").read_text(encoding="utf-8")
    needed = tomllib.loads((LIVE / "chapters.toml").read_text(encoding="utf-8"))
    for file in LOCK["file"]:
        assert re.fullmatch("[0-9a-f]{64}", file["sha256"])
        assert file["licence"]
    assert {part for parts in needed.values() for part in parts} <= PARTS
    assert needed.keys() == set(recorded.CHAPTERS)
    named = set(re.findall(r'^\s+\w+: "(\w+)",$', script, re.MULTILINE))
    assert named <= PARTS
    assert PARTS - named <= {"engine", "base", "tests"}


def test_no_file_of_the_engine_names_a_registry():
    for place in [*LIVE.iterdir(), *(ROOT / "book" / "_static").glob("rerun*"), ROOT / ".ci/live"]:
        if place.is_file():
            assert not re.search(r"pypi\.|npmjs\.|jsdelivr|githubusercontent", place.read_text())


def test_a_script_hands_over_the_bytes_of_its_file():
    pack = load_script(LIVE / "pack.py")
    text = pack.script('a "name".whl', b"\0bytes\xff" * 9)
    name, content = json.loads(f"[{text.removeprefix('rerunTake(').removesuffix(');' + chr(10))}]")
    assert name == 'a "name".whl'
    assert gzip.decompress(base64.b64decode(content)) == b"\0bytes\xff" * 9


def test_a_chapter_hands_over_its_cells_by_their_number_in_the_notebook():
    pack = load_script(LIVE / "pack.py")
    notebook = ROOT / "notebooks" / f"{recorded.file_stem('region')}.ipynb"
    told = pack.chapter(notebook)
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    assert told["recorded"] == sum(one["chapter"] == "region" for one in recorded.results())
    code = [k for k, cell in enumerate(cells) if cell["cell_type"] == "code"]
    assert [cell["index"] for cell in told["cells"]] == code
    assert all(cell["source"] == "".join(cells[cell["index"]]["source"]) for cell in told["cells"])


def test_a_chapter_allows_the_scripts_in_its_page_by_their_hashes_and_no_others():
    extension = load_script(ROOT / "book" / "_ext" / "rerun.py")
    scripts = (
        "<script>let a = 1;</script><script data-b='2' src='c.js'></script>\n<script\n>d</script>"
    )
    page = f'<head>\n<meta charset="utf-8" />{scripts}</head>'
    text = extension.with_policy(page)
    asked = next(each for each in text.split(";") if each.startswith(" script-src"))
    hashes = {base64.b64encode(hashlib.sha256(each).digest()) for each in (b"let a = 1;", b"d")}
    assert set(re.findall("'sha256-([^']+)'", asked)) == {each.decode() for each in hashes}
    assert not re.search(r"'unsafe-|https?:|\*", asked)
    assert text.index("Content-Security-Policy") < text.index("<script")
    assert extension.with_policy(text) == text


def test_the_archive_of_the_library_has_what_a_wheel_would_have():
    library = load_script(LIVE / "library.py")
    with zipfile.ZipFile(io.BytesIO(library.library())) as archive:
        names = set(archive.namelist())
        told = [archive.read(name).decode() for name in names if name.endswith("METADATA")]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert len(told) == 2
    assert all(f"Version: {project['version']}" in text for text in told)
    assert {"cspace/check.py", "cspace/robots/ur5.urdf", "lizarraga2025/side_by_side.json"} <= names
    assert "lizarraga2025/recorded_results/region.json" in names
    assert library.library() == library.library()


@pytest.mark.parametrize(
    ("error", "text", "line"),
    [
        ("not TOML: Invalid value (at line 3, column 8)", "", 3),
        ("joint[1].axis (elbow): [0] has length 1", "[[joint]]\n[[joint]]\naxis = [0]", 3),
        ("joint[1].axis: [0]", "joint = [{ axis = [1] },\n  { axis = [0] }]", 2),
        ("unknown key 'nam'; allowed: name", "schema = 1\nnam = 'arm'", 2),
        ("home.sholder: no joint 'sholder'", "schema = 1\nhome = { sholder = 1 }", 2),
        ("something else", "schema = 1", 0),
    ],
)
def test_an_error_of_a_robot_file_finds_its_line(error, text, line):
    assert load_script(LIVE / "try_desk.py").line_of(error, text) == line
