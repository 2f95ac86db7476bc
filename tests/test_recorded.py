"""The recorded results: one id, one meaning; one quantity, one result; errors; citations."""

from __future__ import annotations

import ast
import hashlib
import importlib
import re
import subprocess
from collections import defaultdict
from collections.abc import Iterator
from decimal import Decimal
from itertools import combinations
from pathlib import Path
from types import ModuleType
from typing import Any

import jupytext
import mpmath as mp
import numpy as np
import pytest
from bs4 import BeautifulSoup
from pybtex.database import parse_string
from scipy.spatial import cKDTree

from lizarraga2025 import printed as paper
from lizarraga2025 import recorded
from lizarraga2025.evidence.joint_region import scaled
from lizarraga2025.evidence.tool_paths import LEFT, RIGHT
from lizarraga2025.ledger import cite
from lizarraga2025.ledger.cite import State, escaped, state
from lizarraga2025.ledger.claims import from_content
from lizarraga2025.results import grid_error
from qbound import figures, load_robot
from qbound.cli import main
from qbound.model.robotfile import is_urdf, robot_text
from qbound.paths.traversal import traverse
from qbound.symbols import with_symbols
from qbound.urdf.arm import packaged_or_path
from support.scripts import importable

ROOT = Path(__file__).resolve().parent.parent
ENTRIES = recorded.results()
RESULTS: dict[str, dict[str, Any]] = {entry["id"]: entry for entry in recorded.distinct(ENTRIES)}
HEAD = {"chapter", "version", "robots"}

Entry = dict[str, Any]


def numbers(value: Any) -> list[float]:
    if isinstance(value, list):
        return [x for item in value for x in numbers(item)]
    return [value] if isinstance(value, float) else []


# --- meaning --------------------------------------------------------------------------------------


def test_an_id_means_one_thing() -> None:
    """Where two chapters state a result, they state the same."""
    meanings = defaultdict(list)
    for entry in ENTRIES:
        meanings[entry["id"]].append({k: v for k, v in entry.items() if k not in HEAD})
    assert [id_ for id_, all_ in meanings.items() if any(one != all_[0] for one in all_)] == []


def test_ids_have_anchors_and_keys_of_their_own() -> None:
    anchors = [cite.anchor(id_) for id_ in RESULTS]
    assert len(set(anchors)) == len(anchors)
    assert all(re.fullmatch(r"result(-[a-z0-9-]+)+", anchor) for anchor in anchors)


EQUAL_FOR_A_REASON = {
    ("beta_{5,1}.defined", "beta_{6,1}.defined"): "the two walls are mirror images",
    ("workspace.covered_once.paper", "safe_and_unsafe.paper"): (
        "a place that one safe posture reaches has a second posture, which is unsafe"
    ),
}
"""Different quantities with one value."""


def is_long(entry: Entry) -> bool:
    """Tell whether a value has so many digits that chance does not repeat it."""
    return any(
        len(Decimal(repr(x)).normalize().as_tuple().digits) > 6 for x in numbers(entry["value"])
    )


def agree(one: Entry, other: Entry) -> bool:
    x, y = numbers(one["value"]), numbers(other["value"])
    lists = isinstance(one["value"], list), isinstance(other["value"], list)
    if one["unit"] != other["unit"] or len(x) != len(y) or len(set(lists)) > 1:
        return False
    return all(abs(a - b) <= one["error"] + other["error"] for a, b in zip(x, y, strict=True))


def test_one_quantity_is_one_result() -> None:
    """A second id for a value that is there already is a second definition, or has its reason."""
    long = [entry for entry in RESULTS.values() if is_long(entry)]
    pairs = [(a["id"], b["id"]) for a, b in combinations(long, 2) if agree(a, b)]
    assert {frozenset(pair) for pair in pairs} == set(map(frozenset, EQUAL_FOR_A_REASON))


def test_half_a_digit_of_the_print_is_defined_once() -> None:
    """Two formulas for what rounding can do gave 0.0212 cm and 0.0190 cm."""
    files = [*(ROOT / "src/lizarraga2025").rglob("*.py"), *(ROOT / "notebooks").glob("[0-9]*.md")]
    users = [file.name for file in files if re.search(r"(?<![\w.])(0\.005|5e-3)\b", code(file))]
    assert users == ["rounding.py"]


def code(file: Path) -> str:
    if file.suffix == ".py":
        return file.read_text(encoding="utf-8")
    cells = jupytext.read(file).cells
    return "\n".join(cell.source for cell in cells if cell.cell_type == "code")


def test_chapters_stand_in_the_order_of_the_book() -> None:
    notebooks = sorted((ROOT / "notebooks").glob("[0-9]*.md"))
    names = [re.search(r'Results\(\s*"(\w+)"', code(file)) for file in notebooks]
    assert [name[1] for name in names if name] == list(recorded.CHAPTERS)


# --- errors and digits ----------------------------------------------------------------------------


@pytest.mark.parametrize("entry", RESULTS.values(), ids=lambda entry: entry["id"])
def test_no_number_has_more_digits_than_its_error_allows(entry: Entry) -> None:
    error = Decimal(repr(entry["error"]))
    for x in numbers(entry["value"]):
        digits = Decimal(repr(x))
        if error:
            assert digits % Decimal(10) ** error.adjusted() == 0
        else:
            assert len(digits.normalize().as_tuple().digits) <= 12


WRITTEN_OUT = [id_ for id_ in RESULTS if id_.endswith(".digits")]


@pytest.mark.parametrize("name", WRITTEN_OUT)
def test_a_proved_number_lies_within_the_error_of_its_double(name: str) -> None:
    proved, double = RESULTS[name], RESULTS[name.removesuffix(".digits")]
    texts, values = proved["value"], double["value"]
    if isinstance(texts, str):
        texts, values = [texts], [values]
    for text, value in zip(texts, values, strict=True):
        assert abs(Decimal(text) - Decimal(repr(value))) <= Decimal(repr(double["error"]))


@pytest.fixture(scope="module", autouse=True)
def fifty_digits():
    with mp.workdps(50):
        yield


def within(name: str, exact: Any) -> None:
    """Assert that a recorded value is as close to one of fifty digits as it says."""
    entry = RESULTS[name]
    recorded_ = entry["value"] if isinstance(entry["value"], list) else [entry["value"]]
    exact = exact if isinstance(exact, list | tuple) else [exact]
    for value, wanted in zip(recorded_, exact, strict=True):
        assert abs(mp.mpf(repr(value)) - wanted) <= mp.mpf(repr(entry["error"])), name


OFFSETS = {
    str(k): mp.mpf(repr(float(v))) for k, v in with_symbols(load_robot("minervabot-v2"))[1].items()
}


def vertices() -> list[tuple[mp.mpf, mp.mpf]]:
    """Return the six points from their proved digits, rad."""
    proved = [RESULTS[f"vertex.{k}.digits"]["value"] for k in range(1, 7)]
    return [tuple(mp.radians(mp.mpf(x)) for x in point) for point in proved]


def height(q1: Any, q2: Any) -> Any:
    """Return the tool's height above its limit (B7), cm, from the printed offsets alone."""
    z01, x12, z12, x23 = (OFFSETS[n] for n in ("z_{0,1}", "x_{1,2}", "z_{1,2}", "x_{2,3}"))
    return z01 - x12 * mp.sin(q1) + z12 * mp.cos(q1) - x23 * mp.sin(q1 + q2) - mp.mpf("11.32")


def shoelace(p: list[tuple[Any, Any]]) -> tuple[Any, Any, Any]:
    cross = [(a[0] * b[1] - b[0] * a[1], a, b) for a, b in zip(p, p[1:] + p[:1], strict=True)]
    area = sum(c for c, _, _ in cross) / 2
    return (area, *(sum(c * (a[i] + b[i]) for c, a, b in cross) / (6 * area) for i in (0, 1)))


@pytest.mark.parametrize("label", [name for name in RESULTS if name in paper.TABLE_6])
def test_bounds_of_table_6_hold_to_their_error(label: str) -> None:
    import sympy as sp

    formula = paper.expression(paper.TABLE_6[label], arctan="atan2")
    exact = {
        k: sp.Rational(str(float(v)))
        for k, v in with_symbols(load_robot("minervabot-v2"))[1].items()
    }
    within(label, mp.degrees(mp.mpf(str(formula.subs(exact).evalf(40)))))


def test_the_polygon_holds_to_its_error() -> None:
    area, *centre = shoelace(vertices())
    within("polygon.area", area)
    within("polygon.area.deg", area * mp.degrees(1) ** 2)
    within("polygon.centroid", [mp.degrees(x) for x in centre])


def edge_in_height(k: int) -> Any:
    """Return the edge from point k to the next, and the height on it, both by its parameter."""
    p = vertices()
    (a1, a2), (b1, b2) = p[k - 1], p[k % 6]
    return lambda t: (a1 + t * (b1 - a1), a2 + t * (b2 - a2))


@pytest.mark.parametrize("k", [3, 6])
def test_depths_of_the_edges_hold_to_their_error(k: int) -> None:
    edge = edge_in_height(k)
    lowest = mp.findroot(lambda t: mp.diff(lambda s: height(*edge(s)), t), 0.5)
    within(f"edge.{k}.depth", -height(*edge(lowest)))


def test_the_largest_safe_scale_holds_to_its_error() -> None:
    """At the scale an edge touches the floor's curve: no height and no slope along the edge."""
    _, *centre = shoelace(vertices())
    found = []
    for k in (3, 6):
        edge = edge_in_height(k)

        def scaled(s: Any, t: Any, edge: Any = edge) -> Any:
            q = edge(t)
            return height(*(c + s * (x - c) for c, x in zip(centre, q, strict=True)))

        slope = lambda s, t, scaled=scaled: mp.diff(lambda u: scaled(s, u), t)  # noqa: E731
        s, _ = mp.findroot(lambda s, t, a=scaled, b=slope: [a(s, t), b(s, t)], (0.96, 0.5))
        found.append(s)
    within("largest_scale.area", min(found))


def test_parts_of_a_turn_hold_to_their_error() -> None:
    """The wall cuts the circle of q2 where sine or cosine of an angle of q1 is small enough."""
    x12, z12, x23, z01 = (OFFSETS[n] for n in ("x_{1,2}", "z_{1,2}", "x_{2,3}", "z_{0,1}"))
    link = mp.hypot(x12, z12)

    def part(middle: Any) -> Any:
        low, high = (max(-1, min(1, (middle + s * x23) / link)) for s in (-1, 1))
        return 100 * (mp.acos(low) - mp.acos(high)) / mp.pi

    within("beta_{5,1}.defined", part(mp.mpf(-15)))
    within("beta_{6,1}.defined", part(mp.mpf(15)))
    within("beta_{7,3}.defined", part(mp.mpf("11.32") - z01))


def test_a_sample_is_within_five_standard_errors_of_the_exact_part() -> None:
    sampled, exact = RESULTS["free.feasible"], RESULTS["free.exact"]
    assert abs(sampled["value"] - exact["value"]) < sampled["error"]
    sampled, exact = RESULTS["safe_and_unsafe.sampled"], RESULTS["safe_and_unsafe.paper"]
    assert abs(sampled["value"] - exact["value"]) < sampled["error"]
    assert sampled["error"] > 5 * 10


def test_asymmetry_holds_to_its_error() -> None:
    """Against dense points of both paths: no nearer than one of them, no farther than their gap."""
    arm = load_robot("minervabot-v2")
    points = scaled(0.95)
    paths = [
        traverse(arm, points[list(order)], step=2e-3).tool[:, [0, 2]] for order in (RIGHT, LEFT)
    ]
    mirrored = paths[0] * [-1, 1]
    trees = cKDTree(mirrored), cKDTree(paths[1])
    brute = max(trees[0].query(paths[1])[0].max(), trees[1].query(mirrored)[0].max())
    gap = max(np.linalg.norm(np.diff(path, axis=0), axis=1).max() for path in paths)
    entry = RESULTS["asymmetry.minervabot-v2.0.95"]
    assert brute - gap <= entry["value"] <= brute + entry["error"] + gap
    assert gap < 0.2 * brute


def test_an_area_on_a_grid_is_within_its_error() -> None:
    n = 200
    x = (np.arange(n) + 0.5) * 2 * np.pi / n - np.pi
    inside = np.hypot(*np.meshgrid(x, x)) < 2
    cell = (2 * np.pi / n) ** 2
    assert 0 < abs(cell * inside.sum() - 4 * np.pi) < grid_error(inside, cell) < 2


# --- robots ---------------------------------------------------------------------------------------


CHAPTERS = sorted((ROOT / "notebooks").glob("[0-9]*.md"))


@pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda f: f.stem)
def test_a_chapter_names_the_robots_that_it_loads(chapter: Path) -> None:
    tree = ast.parse(code(chapter))
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    named = {ast.unparse(call.func): call for call in calls}
    loaded = {
        call.args[0].value
        for call in calls
        if ast.unparse(call.func) in ("load_robot", "exact_robot")
        and isinstance(call.args[0], ast.Constant)
    }
    own = named["Results"].args[0].value
    entry = next(entry for entry in ENTRIES if entry["chapter"] == own)
    assert loaded <= set(entry["robots"])
    for name in loaded:
        urdf = packaged_or_path(name)
        text = urdf.read_text("utf-8") if is_urdf(urdf) else robot_text(name)[0]
        assert entry["robots"][name] == hashlib.sha256(text.encode()).hexdigest()


# --- citations ------------------------------------------------------------------------------------


def said(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert main(list(words)) == 0
    return capsys.readouterr().out


def check_bibtex(text: str, entries: int) -> None:
    """Read as BibTeX does, and see nothing that LaTeX would stumble over (pybtex parses)."""
    assert text.isascii()
    parsed = parse_string(text, "bibtex").entries
    assert len(parsed) == entries
    for entry in parsed.values():
        for field in entry.fields.values():
            text = re.sub(r"(?<!\\)\$[^$]*\$", "", field)  # formulas
            assert not re.search(r"(?<!\\)[_#%&$^]", text)


def test_bibtex_of_every_result_compiles(capsys: pytest.CaptureFixture[str]) -> None:
    check_bibtex(said(capsys, "results", "--bibtex"), 2 + len(RESULTS))


def test_bibtex_of_every_claim_compiles(capsys: pytest.CaptureFixture[str]) -> None:
    check_bibtex(said(capsys, "claims", "--bibtex"), 2 + len(recorded.claims()))


def test_a_citation_states_value_error_version_and_robot(
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = said(capsys, "results", "paper.area", "--bibtex")
    entry = parse_string(text, "bibtex").entries["qbound-result-paper-area"]
    note, wanted = entry.fields["note"], RESULTS["paper.area"]
    assert repr(wanted["value"]) in note
    assert f"{wanted['error']:g}" in note
    assert wanted["robots"]["minervabot-v2"] in note
    assert wanted["version"] in entry.fields["howpublished"]


def test_a_citation_names_the_robots_of_its_result_alone(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The area of one arm's slice named all fourteen robots of its chapter."""
    for entry in recorded.results():
        about = recorded.robots_of(entry)
        assert about.items() <= entry["robots"].items()
        spelled = {name for name in entry["robots"] if "-" in name and name in entry["id"]}
        assert spelled - {"minervabot-v2"} <= set(about)
    note = said(capsys, "results", "scara.slice.area", "--bibtex")
    robots = RESULTS["scara.slice.area"]["robots"]
    assert [name for name in robots if f"{name}, sha256" in note] == [
        "scara.urdf",
        "scara.srdf",
    ]


def test_a_citation_names_the_commit_and_the_tree(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The version is that of many states; it was 0.3.0 for what came long after that release."""
    here = State("1234567890ab" + 28 * "0", "swh:1:dir:" + 40 * "a")
    monkeypatch.setattr(cite, "state", lambda: here)
    entries = parse_string(said(capsys, "results", "paper.area", "--bibtex"), "bibtex").entries
    assert entries["qbound"].fields["swhid"] == here.swhid
    assert entries["qbound"].fields["note"] == "Commit 1234567890ab"
    assert "commit 1234567890ab" in entries["qbound-result-paper-area"].fields["howpublished"]


def test_the_state_is_gits_and_a_changed_file_has_no_tree(tmp_path: Path) -> None:
    def git(*words: str) -> str:
        me = ["-c", "user.name=n", "-c", "user.email=e", "-c", "commit.gpgsign=false"]
        command = ["git", *me, *words]
        return subprocess.run(
            command, cwd=tmp_path, check=True, capture_output=True, text=True
        ).stdout.strip()

    assert state(tmp_path / "nowhere") is None
    git("init", "-q")
    (tmp_path / "file").write_text("one")
    git("add", "file")
    git("commit", "-qm", "one")
    assert state(tmp_path) == State(git("rev-parse", "HEAD"), "swh:1:dir:" + git("write-tree"))
    (tmp_path / "file").write_text("two")
    state.cache_clear()
    changed = state(tmp_path)
    assert changed == State(git("rev-parse", "HEAD"), "")
    assert changed.text.endswith(" with changes")
    state.cache_clear()


# --- what a result is -----------------------------------------------------------------------------


def test_every_result_has_a_sentence_and_every_sentence_a_result() -> None:
    patterns = {recorded.pattern_of(name) for name in RESULTS}
    assert patterns == set(recorded.sentences())
    for name in RESULTS:
        sentence = recorded.sentence(name)
        assert re.fullmatch(r"[A-Zb].{15,}\.", sentence), name
        assert not re.search(r"[{}]", sentence), name
    with pytest.raises(ValueError, match="no sentence says what this result is"):
        recorded.sentence("no.such.result")


def test_results_are_found_by_a_word_of_their_description(
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = said(capsys, "results", "Centroid")
    assert "region/paper.centroid = " in text
    assert "introduction/polygon.centroid = " in text
    assert "the area to cite" in said(capsys, "results", "paper.area")
    assert (
        said(capsys, "results", "paper.area").count(" = ") == 3
    )  # an id is no word: three chapters
    assert main(["results", "no such word"]) == 2
    assert "no result 'no such word'" in capsys.readouterr().err


def test_times_are_no_results_and_the_command_says_where_they_are(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """They were 579 of 1158 results, five of them 0.0 s."""
    assert [name for name in RESULTS if name.endswith(".time")] == []
    assert main(["results", "side.stream-paper-10m-qbound-compiled.time"]) == 2
    told = capsys.readouterr().err
    assert "'stream-paper-10m-qbound-compiled' in benchmarks/side_by_side.json" in told
    assert "0.0423 s" in told


def test_greek_and_signs_become_latex() -> None:
    assert escaped("β_{1,3}, 50%, Δ") == (
        r"$\beta$\_\textbraceleft{}1,3\textbraceright{}, 50\%, $\Delta$"
    )
    assert escaped("González, 3° ≥ 2") == r"Gonz{\'a}lez, 3\textdegree{} $\geq$ 2"
    with pytest.raises(ValueError, match="no LaTeX known"):
        escaped("漢")


def test_a_claim_with_greek_is_cited_in_ascii() -> None:
    content = {**recorded.claims()[0], "where": "Table 6, β_{3,3,2}"}
    text = cite.entry(from_content(content))
    assert text.isascii()
    assert r"$\beta$" in text


# --- the page -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pages() -> Iterator[ModuleType]:
    """The book's extension that writes the tables."""
    with importable(ROOT / "book" / "_ext"):
        yield importlib.import_module("result_pages")


@pytest.fixture(scope="module")
def page(pages: ModuleType) -> BeautifulSoup:
    """Return the tables that the directive writes."""
    tables = [pages.table(entries) for _, entries in pages.chapters()]
    return BeautifulSoup("".join(tables), "html.parser")


def test_every_result_has_a_row_with_its_anchor_value_unit_and_error(page: BeautifulSoup) -> None:
    rows = {row["id"]: row for row in page.select("tbody tr")}
    assert len(page.select("tbody tr")) == len(rows) == len(RESULTS)
    for name, entry in RESULTS.items():
        row = rows[cite.anchor(name)]
        head, value, unit, error, _ = row.find_all(["th", "td"])
        assert head.get_text() == name
        assert value.get_text() == figures.minus_signs(cite.value_text(entry["value"]))
        assert unit.get_text() == ("" if entry["unit"] == "1" else entry["unit"].replace("^2", "²"))
        assert error.get_text() == (f"{entry['error']:g}" if entry["error"] else "exact")


def test_every_citation_can_be_read_without_a_script(page: BeautifulSoup) -> None:
    cited = [block.get_text() for block in page.select("details.citation .bibtex")]
    assert cited == [cite.result(entry) for entry in RESULTS.values()]


def test_an_id_of_a_stranger_stays_text(pages: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (recorded, cite):
        monkeypatch.setattr(module, "sentence", lambda name: f"{name}.")
    entry = RESULTS["paper.area"] | {"id": "<b>&", "value": "<script>"}
    row = BeautifulSoup(pages.row(entry), "html.parser")
    assert row.find(["b", "script"]) is None
