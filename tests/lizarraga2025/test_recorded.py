"""The recorded results: one id, one meaning; one quantity, one result; errors; citations."""

from __future__ import annotations

import ast
import hashlib
import importlib
import json
import math
import re
import subprocess
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from decimal import Decimal
from importlib import resources
from itertools import combinations
from pathlib import Path
from types import ModuleType
from typing import Any

import jupytext
import mpmath as mp
import numpy as np
import pytest
from bs4 import BeautifulSoup
from hypothesis import given
from hypothesis import strategies as st
from pybtex.database import parse_string

from cspace import __version__, figures, load_robot
from cspace.model.robotfile import is_urdf, robot_text
from cspace.urdf.arm import packaged_or_path
from engine_support.commands import follows_schema
from engine_support.scripts import importable
from lizarraga2025 import printed as paper
from lizarraga2025 import recorded
from lizarraga2025.commands import main
from lizarraga2025.ledger import cite
from lizarraga2025.ledger.cite import State, escaped, state
from lizarraga2025.ledger.claims import from_content
from lizarraga2025.ledger.errata import change, errata
from lizarraga2025.ledger.page import errata_list, ledger_table, typeset
from lizarraga2025.results import EXACT, Results, grid_error, last_place, places, share_of_error
from lizarraga2025.typeset import latex
from qbound.symbols import offset_values

ROOT = Path(__file__).resolve().parents[2]
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
    return all(
        abs(a - b) <= one["numerical_error"] + other["numerical_error"]
        for a, b in zip(x, y, strict=True)
    )


def test_one_quantity_is_one_result() -> None:
    """A second id for a value that is there already is a second definition, or has its reason."""
    long = [entry for entry in RESULTS.values() if is_long(entry)]
    pairs = [(a["id"], b["id"]) for a, b in combinations(long, 2) if agree(a, b)]
    assert {frozenset(pair) for pair in pairs} == set(map(frozenset, EQUAL_FOR_A_REASON))


def test_half_a_digit_of_the_print_is_defined_once() -> None:
    """Two formulas for what rounding can do gave 0.0212 cm and 0.0190 cm."""
    files = [*(ROOT / "src/lizarraga2025").rglob("*.py"), *(ROOT / "notebooks").glob("[0-9]*.md")]
    users = [file.name for file in files if re.search(r"(?<![\w.])(0\.005|5e-3)\b", code(file))]
    assert users == ["printed.py"]


def code(file: Path) -> str:
    if file.suffix == ".py":
        return file.read_text(encoding="utf-8")
    cells = jupytext.read(file).cells
    return "\n".join(cell.source for cell in cells if cell.cell_type == "code")


def test_a_chapter_records_under_its_name_and_those_merged_into_it() -> None:
    for file in sorted((ROOT / "notebooks").glob("[0-9]*.md")):
        first, *merged = re.findall(r'Results\(\s*"(\w+)"', code(file))
        assert first == file.stem[3:]
        assert {recorded.chapter_of(name) for name in merged} <= {first}


# --- errors and digits ----------------------------------------------------------------------------


def has_no_more_digits_than_its_error_allows(entry: Entry) -> bool:
    error = Decimal(repr(entry["numerical_error"]))
    digits = [Decimal(repr(x)) for x in numbers(entry["value"])]
    if error:
        return all(x % Decimal(10) ** error.adjusted() == 0 for x in digits)
    return all(len(x.normalize().as_tuple().digits) <= 12 for x in digits)


def test_no_number_has_more_digits_than_its_error_allows() -> None:
    wrong = [e["id"] for e in RESULTS.values() if not has_no_more_digits_than_its_error_allows(e)]
    assert wrong == []


WRITTEN_OUT = [id_ for id_ in RESULTS if id_.endswith(".digits")]


@pytest.mark.parametrize("name", WRITTEN_OUT)
def test_a_proved_number_lies_within_the_error_of_its_double(name: str) -> None:
    proved, double = RESULTS[name], RESULTS[name.removesuffix(".digits")]
    texts, values = proved["value"], double["value"]
    if isinstance(texts, str):
        texts, values = [texts], [values]
    for text, value in zip(texts, values, strict=True):
        assert abs(Decimal(text) - Decimal(repr(value))) <= Decimal(repr(double["numerical_error"]))


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
        assert abs(mp.mpf(repr(value)) - wanted) <= mp.mpf(repr(entry["numerical_error"])), name


OFFSETS = {
    str(k): mp.mpf(repr(float(v))) for k, v in offset_values(load_robot("minervabot-v2")).items()
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
        k: sp.Rational(str(float(v))) for k, v in offset_values(load_robot("minervabot-v2")).items()
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
    assert abs(sampled["value"] - exact["value"]) < sampled["numerical_error"]
    sampled, exact = RESULTS["safe_and_unsafe.sampled"], RESULTS["safe_and_unsafe.paper"]
    assert abs(sampled["value"] - exact["value"]) < sampled["numerical_error"]
    assert sampled["numerical_error"] > 5 * 10


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
    loaded = {
        call.args[0].value
        for call in calls
        if ast.unparse(call.func) in ("load_robot", "exact_robot")
        and isinstance(call.args[0], ast.Constant)
    }
    own = {call.args[0].value for call in calls if ast.unparse(call.func) == "Results"}
    robots = {n: h for e in ENTRIES if e["chapter"] in own for n, h in e["robots"].items()}
    assert loaded <= set(robots)
    for name in loaded:
        urdf = packaged_or_path(name)
        text = urdf.read_text("utf-8") if is_urdf(urdf) else robot_text(name)[0]
        assert robots[name] == hashlib.sha256(text.encode()).hexdigest()


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


def test_bibtex_of_every_result_and_claim_compiles(capsys: pytest.CaptureFixture[str]) -> None:
    check_bibtex(said(capsys, "results", "--bibtex"), len(RESULTS))
    check_bibtex(said(capsys, "claims", "--bibtex"), len(recorded.claims()))


def test_what_the_commands_print_stands_in_one_bibtex_file(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Each printed the entries of paper and package again, which BibTeX refuses."""
    asked = (["cite"], ["results", "paper.area"], ["results", "vertex.1"], ["claims", "E-34"])
    text = "".join(said(capsys, *words, *["--bibtex"][: len(words) - 1]) for words in asked)
    check_bibtex(text, 5)
    assert {"Lizarraga2025", "qbound"} < set(parse_string(text, "bibtex").entries)


def test_a_citation_states_value_error_version_and_robot(
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = said(capsys, "results", "paper.area", "--bibtex")
    entry = parse_string(text, "bibtex").entries["qbound-result-paper-area"]
    note, wanted = entry.fields["note"], RESULTS["paper.area"]
    assert repr(wanted["value"]) in note
    assert f"{wanted['numerical_error']:g}" in note
    assert wanted["robots"]["minervabot-v2"] in note
    assert f"qbound {wanted['version']}" in note
    assert f"{wanted['input_uncertainty']:g}" in note


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
    named = [name for name in robots if f"{name}, sha256" in note]
    assert named == ["scara.urdf", "scara.srdf"]


def test_a_citation_names_the_commit_and_the_tree(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The version is that of many states; it was 0.3.0 for what came long after that release."""
    here = State("1234567890ab" + 28 * "0", "swh:1:dir:" + 40 * "a")
    monkeypatch.setattr(cite, "state", lambda: here)
    text = said(capsys, "cite") + said(capsys, "results", "paper.area", "--bibtex")
    entries = parse_string(text, "bibtex").entries
    assert entries["qbound"].fields["swhid"] == here.swhid
    assert entries["qbound"].fields["note"] == "Unpublished. Commit 1234567890ab"
    assert "commit 1234567890ab" in entries["qbound-result-paper-area"].fields["note"]


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
    assert "by the windows of Table 6" in said(capsys, "results", "paper.area")
    # an id is no word: three chapters
    assert said(capsys, "results", "paper.area").count(" = ") == 3
    assert main(["results", "no such word"]) == 2
    assert "no result 'no such word'" in capsys.readouterr().err


def test_times_are_no_results_and_the_command_says_where_they_are(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """They were 579 of 1158 results, five of them 0.0 s."""
    assert [name for name in RESULTS if name.endswith(".time")] == []
    assert main(["results", "side.stream-paper-10m-qbound-compiled.time"]) == 2
    told = capsys.readouterr().err
    assert "'stream-paper-10m-qbound-compiled' in engine/benchmarks/side_by_side.json" in told
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
        yield importlib.import_module("recorded_numbers")


@pytest.fixture(scope="module")
def page(pages: ModuleType) -> BeautifulSoup:
    """Return the tables that the directive writes."""
    entries = recorded.distinct(recorded.results())
    return BeautifulSoup(pages.table(entries), "html.parser")


def test_every_result_has_a_row_with_its_anchor_value_unit_and_error(page: BeautifulSoup) -> None:
    rows = {row["id"]: row for row in page.select("tbody tr")}
    assert len(page.select("tbody tr")) == len(rows) == len(RESULTS)
    for name, entry in RESULTS.items():
        row = rows[cite.anchor(name)]
        head, value, unit, error, open_, _ = row.find_all(["th", "td"])
        assert head.get_text() == name
        assert value.get_text() == figures.minus_signs(cite.value_text(entry["value"]))
        assert unit.get_text() == ("" if entry["unit"] == "1" else entry["unit"].replace("^2", "²"))
        bound = entry["input_uncertainty"]
        assert open_.get_text() == ("–" if bound is None else f"{bound:g}")
        assert error.get_text() == (
            f"{entry['numerical_error']:g}" if entry["numerical_error"] else "exact"
        )


def test_every_citation_can_be_read_without_a_script(page: BeautifulSoup) -> None:
    cited = [block.get_text() for block in page.select("details.citation .bibtex")]
    assert cited == [cite.result(entry) for entry in RESULTS.values()]


def test_an_id_of_a_stranger_stays_text(pages: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (recorded, cite):
        monkeypatch.setattr(module, "sentence", lambda name: f"{name}.")
    entry = RESULTS["paper.area"] | {"id": "<b>&", "value": "<script>"}
    row = BeautifulSoup(pages.row(entry), "html.parser")
    assert row.find(["b", "script"]) is None


# --- results --------------------------------------------------------------------------------------


def example() -> Results:
    results = Results("region", "minervabot-v2")
    area = np.float64(2 / 3)
    of = {"reference": "Figure 5", "reading": "windows"}
    results.add("area", area, "deg^2", numerical_error=1e-13, **of)
    results.add(
        "vertex", np.array([[1 / 3, -1e-7], [0.1, 23456.7890123456]]), "deg", numerical_error=4e-11
    )
    results.add("count", 6, "1", numerical_error=EXACT)
    results.add(
        "curves", ["β_{1,3,1}", "beta_{4,1,2}"], "1", numerical_error=EXACT, reading="clearance"
    )
    return results


def test_file_has_the_promised_form(tmp_path: Path) -> None:
    path = example().save(tmp_path)
    assert path == tmp_path / "region.json"
    content = json.loads(path.read_text(encoding="utf-8"))
    follows_schema(content, "results", "lizarraga2025")
    assert (content["schema"], content["version"]) == ("qbound/results/3", __version__)
    assert content["chapter"] == "region"
    assert [entry["id"] for entry in content["results"]] == ["area", "vertex", "count", "curves"]
    area, vertex, count, curves = content["results"]
    assert area == {
        "id": "area", "value": 0.6666666666667, "unit": "deg^2", "reference": "Figure 5",
        "reading": "windows", "numerical_error": 1.5e-13, "input_uncertainty": None,
    }  # fmt: skip
    assert vertex["value"] == [[0.33333333333, -1e-7], [0.1, 23456.7890123456]]
    assert (count["value"], count["reference"], count["reading"]) == (6, "", "none")
    assert curves["value"] == ["β_{1,3,1}", "beta_{4,1,2}"]


def test_a_robot_is_named_by_the_hash_of_its_file() -> None:
    text, _ = robot_text("minervabot-v2")
    results = Results("region", "minervabot-v2")
    results.about("arm", "another")
    texts = {"minervabot-v2": text, "arm": "another"}
    assert results.robots == {k: hashlib.sha256(t.encode()).hexdigest() for k, t in texts.items()}


# --- errors and digits ----------------------------------------------------------------------------


@pytest.mark.parametrize("error", [-1.0, np.nan, np.inf])
def test_a_bound_is_a_number_that_is_not_negative(error: float) -> None:
    with pytest.raises(ValueError, match=r"n: .* is no bound of an error"):
        Results("x").add("n", 1.5, "1", numerical_error=error)


def test_what_was_computed_is_no_exact_decimal() -> None:
    results = Results("x")
    with pytest.raises(ValueError, match="state its error"):
        results.add("n", 1 / 3, "1", numerical_error=EXACT)
    results.add("n", 0.95, "1", numerical_error=EXACT)
    assert results.entries[0]["value"] == 0.95


MAGNITUDES = st.floats(-1e9, 1e9, allow_subnormal=False)
ERRORS = st.floats(-15, 6).map(lambda exponent: 10.0**exponent)


@given(MAGNITUDES, ERRORS)
def test_a_number_has_the_digits_that_its_error_allows(number: float, error: float) -> None:
    """What is written is a multiple of a place within the error, and the error covers both."""
    results = Results("x")
    results.add("n", number, "1", numerical_error=error)
    (entry,) = results.entries
    place = Decimal(10) ** -places(max(error, float(np.spacing(abs(number)))))
    assert Decimal(repr(entry["value"])) % place == 0
    assert float(place) <= entry["numerical_error"] * (2 + 1e-12)
    rounded = abs(entry["value"] - number) - float(np.spacing(abs(number)))
    assert rounded + error <= entry["numerical_error"] * (1 + 1e-9)
    assert entry["numerical_error"] <= 2.3 * max(error, float(np.spacing(abs(number))))


def test_numbers_written_out_have_the_error_of_their_last_place() -> None:
    assert last_place("-94.073421", "2.5") == 0.1
    assert last_place("0.650011309404") == 1e-12


# --- files ----------------------------------------------------------------------------------------


def test_same_bytes_on_a_second_run(tmp_path: Path) -> None:
    first = example().save(tmp_path).read_bytes()
    assert example().save(tmp_path).read_bytes() == first
    assert first.endswith(b"\n")
    assert "β".encode() in first
    assert b"\r" not in first


def test_add_returns_the_value_itself() -> None:
    value = np.array([1.0, 2.0])
    assert Results("x").add("v", value, "cm", numerical_error=1e-12) is value


@pytest.mark.parametrize(
    ("value", "plain"),
    [
        (np.int64(3), 3), (np.array([1, 2]), [1, 2]), ((1, 2.5), [1, 2.5]), (True, True),
        (np.array(2.5), 2.5), (np.float32(0.5), 0.5), ([[np.int32(7)]], [[7]]), (np.bool_(1), True),
    ],
    ids=str,
)  # fmt: skip
def test_numpy_values_become_plain_ones_of_their_kind(value, plain) -> None:
    """A count stays a whole number in the file."""
    results = Results("x")
    results.add("v", value, "1", numerical_error=1e-12)
    assert json.dumps(results.entries[0]["value"]) == json.dumps(plain)


BAD = [np.nan, np.inf, -np.inf, [1.0, np.nan], np.array([[1, 2], [3, np.inf]])]


@pytest.mark.parametrize("value", BAD, ids=str)
def test_a_number_that_is_not_finite_is_refused(value) -> None:
    results = Results("x")
    with pytest.raises(ValueError, match="is no result"):
        results.add("v", value, "1", numerical_error=1e-12)
    assert results.entries == []


def test_an_id_is_unique_within_its_chapter() -> None:
    results = example()
    with pytest.raises(ValueError, match="'area' is there already"):
        results.add("area", 1.0, "deg^2", numerical_error=EXACT)
    assert len(results.entries) == 4


def test_the_folder_is_the_argument_then_the_environments(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("QBOUND_RESULTS", str(tmp_path / "elsewhere"))
    assert example().save() == tmp_path / "elsewhere" / "region.json"
    assert example().save(tmp_path / "here") == tmp_path / "here" / "region.json"


def test_outside_of_a_build_nothing_is_written_and_a_line_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In a project, too: what a reader tries in a chapter changes no file that git tracks."""
    (tmp_path / "pyproject.toml").touch()
    (tmp_path / "results").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("QBOUND_RESULTS", raising=False)
    assert example().save() is None
    [line] = capsys.readouterr().out.splitlines()
    assert line == "region.json is not written: results are recorded with the book."
    assert list((tmp_path / "results").iterdir()) == []


# --- a result and its earlier self ----------------------------------------------------------------

ENTRY = {"id": "a", "unit": "cm", "value": [1.5, 2.0, "up", 3], "numerical_error": 0.015}


@pytest.mark.parametrize(
    ("change", "share"),
    [
        ({}, 0.0),
        ({"value": [1.5, 2.003, "up", 3]}, 0.2),
        ({"value": [1.53, 2.0, "up", 3]}, 2.0),
        ({"value": [1.5, 2.0, "up", 4]}, math.inf),
        ({"value": [1.5, 2.0, "down", 3]}, math.inf),
        ({"value": [1.5, 2.0, "up"]}, math.inf),
        ({"unit": "mm"}, math.inf),
        ({"numerical_error": 0.016}, 0.0),
        ({"numerical_error": 0.03}, math.inf),
    ],
)
def test_a_result_is_compared_by_its_stated_error(change: dict, share: float) -> None:
    assert share_of_error(ENTRY | change, ENTRY) == pytest.approx(share)


def test_an_exact_result_has_to_be_the_same() -> None:
    exact = {"id": "a", "unit": "cm", "value": 2.5, "numerical_error": 0.0}
    assert share_of_error(exact, exact) == 0
    assert share_of_error(exact | {"value": 2.5000001}, exact) == math.inf


# --- the errata -----------------------------------------------------------------------------------


LEDGER = [from_content(content) for content in recorded.claims()]
PARTS = errata(LEDGER)
FILE = resources.files("lizarraga2025") / "ledger" / "statements" / "errata.toml"


def test_all_that_does_not_hold_is_listed_once() -> None:
    listed = [one.id for entries in PARTS.values() for one in entries]
    assert len(set(listed)) == len(listed)
    assert {one.id for one in LEDGER if one.most_favourable in ("misprint", "refuted")} <= set(
        listed
    )
    assert not {one.id for one in LEDGER if one.stands} & set(listed)


def test_the_errata_print_nothing_that_the_ledger_does_not_hold() -> None:
    """No rule of this arm for every robot, no cause that is none, no unit that is open."""
    assert "S-30.1" not in {one.id for entries in PARTS.values() for one in entries}
    assert not {"T-5", "T-5.1", "T-5.2"} & {one.id for one in PARTS["T-4.1"]}
    assert "Table 5" not in change("T-4.1")[0]
    assert "third" not in change("E-9")[1]
    assert "due to" not in change("F-10.2")[1]


def test_the_inverse_tangent_has_its_part() -> None:
    assert {"E-34", "T-6.3", "T-6.6", "B-2.1.1", "B-3.3.2"} <= {one.id for one in PARTS["E-34"]}


@pytest.mark.parametrize("leader", PARTS)
def test_a_part_is_one_finding(leader: str) -> None:
    assert len({one.finding for one in PARTS[leader]}) == 1
    assert leader in {one.id for one in PARTS[leader]}


def test_every_typed_change_leads_a_part() -> None:
    assert set(tomllib.loads(FILE.read_text(encoding="utf-8"))) <= set(PARTS)


@pytest.mark.parametrize("leader", [name for name in PARTS if name.startswith("T-6.")])
def test_a_row_of_table_6_changes_a_sign_of_the_printed_bounds(leader: str) -> None:
    printed, proposed = change(leader)
    bounds = [one.id.removeprefix("B-").split(".") for one in PARTS[leader] if one.kind == "bound"]
    labels = ["beta_{{{},{},{}}}".format(*indices) for indices in bounds]
    assert printed.splitlines() == [rf"$\{b} = {latex(paper.TABLE_6[b])}$" for b in labels]
    assert proposed == printed.replace(r"- \cos^{-1}", r"+ \cos^{-1}") != printed


def test_tex_between_dollar_signs_is_handed_to_the_script_and_all_else_is_escaped() -> None:
    assert typeset("<b> $a < b$ q_1") == (
        '&lt;b&gt; <span class="math notranslate">\\(a &lt; b\\)</span> q<sub>1</sub>'
    )


def test_the_pages_of_an_empty_ledger_are_empty() -> None:
    assert "<dl" not in errata_list({})
    assert "0 statements of the paper, 0 findings" in ledger_table([])


# --- a printed formula is shown with its terms in the order of the print --------------------------


AS_PRINTED = {  # Table 6 and eq. (29), as the journal sets them
    "beta_{1,1,2}": (
        r"\cos^{-1}\left(\frac{x_{0,6}}{\sqrt{x_{1,7}^{2} + z_{1,7}^{2}}}\right)"
        r" + \tan^{-1}\left(\frac{z_{1,7}}{x_{1,7}}\right) - 2 \pi"
    ),
    "beta_{2,3,2}": (
        r"-\pi + \tan^{-1}\left(\frac{-x_{1,9}}{z_{1,9}}\right)"
        r" - \cos^{-1}\left(\frac{z_{0,1} - z_{0,8}}{\sqrt{x_{1,9}^{2} + z_{1,9}^{2}}}\right)"
    ),
    "beta_{5,1,2}": (
        r"-q_1 - \pi - \cos^{-1}\left(\frac{x_{1,2} \cos(q_1) - x_{\min,1}"
        r" + z_{1,2} \sin(q_1)}{x_{2,3}}\right)"
    ),
    "beta_{7,3}": (
        r"z_{0,1} - z_{\min,1} - x_{2,3} \left(\cos(q_1) \sin(q_2) + \cos(q_2) \sin(q_1)"
        r"\right) + z_{1,2} \cos(q_1) - x_{1,2} \sin(q_1)"
    ),
}


@pytest.mark.parametrize("name", AS_PRINTED)
def test_terms_stand_where_the_paper_has_them(name: str) -> None:
    assert latex((paper.TABLE_6 | paper.EQUATION_29)[name]) == AS_PRINTED[name]


def test_what_is_no_formula_is_refused() -> None:
    with pytest.raises(ValueError, match="no part of a printed formula: x\\[0\\]"):
        latex("x[0]")
