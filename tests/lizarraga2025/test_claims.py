"""The ledger: one test an entry, named by its id, and what every entry must have."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest
from jsonschema import ValidationError

from engine_support.commands import follows_schema
from engine_support.scripts import names_of_tests
from lizarraga2025 import printed as paper
from lizarraga2025 import recorded
from lizarraga2025.commands import main
from lizarraga2025.computations import registry
from lizarraga2025.evidence import proofs
from lizarraga2025.evidence.joint_region import by_windows
from lizarraga2025.evidence.rounding import slips_of_table_4
from lizarraga2025.ledger import cite
from lizarraga2025.ledger.claims import (
    KINDS,
    Claim,
    Count,
    claim,
    counts,
    entries,
    findings,
    from_content,
    identifiers,
    join,
    read,
)
from lizarraga2025.verdicts import VERDICTS, Outcome, judge, of_readings, undetermined

ROOT = Path(__file__).resolve().parents[2]
EXPECTED = tomllib.loads(
    (ROOT / "tests" / "lizarraga2025" / "verdicts.toml").read_text(encoding="utf-8")
)
VERDICT = {
    name: (verdict, verdict) if isinstance(verdict, str) else tuple(verdict)
    for kind in EXPECTED.values()
    for name, verdict in kind.items()
}
"""Of the likeliest reading and of the most favourable one."""
KIND = {name: kind for kind, names in EXPECTED.items() for name in names}


every_id = pytest.mark.parametrize("name", identifiers())


@cache
def computed(name: str):
    return claim(name)


# --- each entry -----------------------------------------------------------------------------------


@every_id
def test_verdict(name: str) -> None:
    """The verdicts that the computation gives are those that we came to by thinking."""
    one = computed(name)
    assert (one.likeliest, one.most_favourable) == VERDICT[name], one.computed


@every_id
def test_entry_says_what_was_found_and_where_its_evidence_is(name: str) -> None:
    found = computed(name)
    assert found.kind == KIND[name]
    assert found.where
    for text in (found.says, found.reading, found.computed):
        assert text.strip() == text
        assert not re.search(r"\\|\$|\bnan\b|\binf\b", text), "plain text, finite numbers"
        assert text.endswith(".")
    assert found.reading != "As printed.", "say how"
    assert bool(found.corrected) or found.most_favourable not in (
        "misprint",
        "needs correction",
        "refuted",
    )
    file, test = found.evidence.test.split("::")
    assert test.startswith("test_")
    assert test in names_of_tests(file)
    chapter, _, anchor = found.evidence.chapter.partition("#")
    assert (ROOT / "notebooks" / f"{recorded.file_stem(chapter)}.md").exists()
    assert anchor


def test_every_expected_entry_is_on_the_list_and_no_other() -> None:
    assert set(VERDICT) == set(identifiers())
    assert len(VERDICT) == sum(len(names) for names in EXPECTED.values())
    assert tuple(EXPECTED) == KINDS
    assert {verdict for both in VERDICT.values() for verdict in both} <= set(VERDICTS)


# --- entries are data, functions compute ----------------------------------------------------------

ENTRY = """
[[entry]]
id = "E-1"
kind = "equation"
where = "eq. (1)"
says = "Something."
reading = "So."
evidence.test = "test_it.py::test_it"
evidence.chapter = "it#it"
"""


def read_text(folder: Path, *texts: str):
    files = [folder / f"{number}.toml" for number, _ in enumerate(texts)]
    for file, text in zip(files, texts, strict=True):
        file.write_text(text, encoding="utf-8")
    return read(files)


def test_an_entry_is_what_its_file_says(tmp_path: Path) -> None:
    more = ENTRY.replace("E-1", "E-2") + 'corrected = "Else."\n'
    assert list(read_text(tmp_path, ENTRY, more)) == ["E-1", "E-2"]
    one, other = read_text(tmp_path, ENTRY + more).values()
    assert (one.says, one.reading, one.corrected) == ("Something.", "So.", "")
    assert other.corrected == "Else."
    assert (one.evidence.test, one.evidence.chapter) == ("test_it.py::test_it", "it#it")


def test_entries_that_rest_on_one_finding_name_the_entry_that_carries_it(tmp_path: Path) -> None:
    second = ENTRY.replace("E-1", "E-2") + 'finding = "E-1"'
    assert [e.finding for e in read_text(tmp_path, ENTRY, second).values()] == ["E-1", "E-1"]


@pytest.mark.parametrize(
    ("texts", "sentence"),
    [
        ([ENTRY + 'mended = ""'], r"0\.toml: .*unexpected keyword argument 'mended'"),
        ([ENTRY + ENTRY.replace("says", "# says")], r"0\.toml: .*missing .*argument: 'says'"),
        ([ENTRY.replace("evidence.test", "# ")], "missing .*argument: 'test'"),
        ([ENTRY.replace('"Something."', "3")], r"0\.toml: E-1: says is no text"),
        ([ENTRY.replace('"equation"', '"idea"')], "E-1: the kind 'idea' is none of equation, "),
        ([ENTRY[: ENTRY.index("evidence")] + 'evidence = "x"'], r"0\.toml: "),
        ([ENTRY + 'finding = "E-2"'], "E-1: the finding 'E-2' is no entry that carries its own"),
        (
            [
                ENTRY + 'finding = "E-2"' + ENTRY.replace("E-1", "E-2") + 'finding = "E-3"',
                ENTRY.replace("E-1", "E-3"),
            ],
            "E-1: the finding 'E-2' is no entry that carries its own",
        ),
        ([ENTRY + ENTRY], r"0\.toml: the id E-1 stands twice"),
        ([ENTRY, ENTRY], r"1\.toml: the id E-1 stands twice"),
        (['page = "x"' + ENTRY], r"0\.toml: the file has page beside its entries"),
        (["entry = 3"], r"0\.toml: "),
        ([ENTRY + "no TOML"], r"0\.toml: .*line 10"),
    ],
)
def test_a_file_of_entries_with_a_fault_is_refused_in_a_sentence(
    tmp_path: Path, texts, sentence
) -> None:
    with pytest.raises(ValueError, match=sentence):
        read_text(tmp_path, *texts)


def test_an_entry_without_a_function_is_refused() -> None:
    functions = {name: f for name, f in registry.by_id().items() if name != "E-34"}
    with pytest.raises(ValueError, match="no function computes the entry E-34"):
        join(entries(), functions)


def test_a_function_without_an_entry_is_refused() -> None:
    statements = {name: entry for name, entry in entries().items() if name != "S-12"}
    with pytest.raises(ValueError, match="a function computes S-12, which is no entry"):
        join(statements, registry.by_id())


def test_two_functions_for_one_entry_are_refused() -> None:
    known = dict(registry.by_id())
    with pytest.raises(ValueError, match="two functions compute the entry E-34"):
        registry.computes("E-34")(known["E-35"])
    assert registry.by_id() == known


def test_a_function_for_several_entries_is_called_with_the_case_of_each(monkeypatch) -> None:
    monkeypatch.setattr(registry, "_BY_ID", dict(registry.by_id()))
    registry.computes_each({"X-1": 1, "X-2": 2})(lambda case: Outcome("confirmed", f"{case}."))
    assert [registry.by_id()[name]().computed for name in ("X-1", "X-2")] == ["1.", "2."]


def test_no_string_of_the_code_names_a_test_or_a_chapter() -> None:
    """They stand in the files of entries, where a referee edits them."""
    named = re.compile(rf"\btest_\w+|\b({'|'.join(recorded.CHAPTERS)})#")
    assert named.search("test_frames.py::test_x")
    assert named.search("vector_labelling#equation-eq-1")
    sources = {
        file: file.read_text(encoding="utf-8")
        for folder in ("src", "engine/cspace")
        for file in (ROOT / folder).rglob("*.py")
    }
    assert len(sources) > 50
    found = [
        f"{file.name}:{node.lineno}: {node.value}"
        for file, source in sources.items()
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
        if named.search(node.value)
    ]
    assert found == []


# --- what the paper has ---------------------------------------------------------------------------


def test_entries_confirmed_by_one_test_are_one_finding() -> None:
    findings: dict[str, set[str]] = {}
    for one in map(computed, identifiers()):
        if one.most_favourable == "confirmed" and one.kind != "given":
            findings.setdefault(one.evidence.test, set()).add(one.finding)
    assert {test: names for test, names in findings.items() if len(names) > 1} == {}


def test_an_entry_without_a_text_of_its_own_points_to_its_finding_which_has_one() -> None:
    ledger = {name: computed(name) for name in identifiers()}
    pointing = [one for one in ledger.values() if re.fullmatch(r"As [A-Z]+-\S+", one.computed)]
    assert len(pointing) > 10
    assert [one.id for one in pointing if one.computed != f"As {one.finding}."] == []
    assert [one.id for one in pointing if ledger[one.finding] in pointing] == []


def test_what_is_given_is_no_finding() -> None:
    ledger = [computed(name) for name in identifiers()]
    given = [one for one in ledger if one.kind == "given"]
    assert len(given) > 10
    assert not {one.id for one in given} & findings(ledger)
    assert counts(given)["confirmed"] == Count(len(given), 0)


def test_a_verdict_of_the_prose_is_that_of_the_entry_named_beside_it() -> None:
    """Such as {verdict}`refuted` (E-9): the errata and the claims cannot drift apart."""
    name = r"(?:E|B|T|F|S|TH)-\d+(?:\.\d+)*"
    beside = re.compile(rf"\{{verdict\}}`([^`]+)`[^`.;:()]*[(,] ?({name}(?:(?:, | and ){name})*)")
    text = "\n".join(p.read_text(encoding="utf-8") for p in (ROOT / "notebooks").glob("[0-9]*.md"))
    found = beside.findall(text)
    assert found
    said = [(v, n) for v, names in found for n in re.findall(name, names)]
    assert [(v, n) for v, n in said if v not in VERDICT[n]] == []


def test_of_the_bounds_those_that_shape_the_region_change_it() -> None:
    """The severity of a bound is typed; which bounds are sides of the region is computed."""
    sides = {"B-{}.{}.{}".format(*paper.indices(b.label)) for b in by_windows().bounds}
    falling = {n for n in identifiers() if KIND[n] == "bound" and not computed(n).stands}
    grave = {name for name in falling if computed(name).severity == "region"}
    assert grave == falling & sides == {"B-2.1.2", "B-3.3.1"}


# --- as recorded ----------------------------------------------------------------------------------


def test_the_recorded_ledger_is_the_computed_one() -> None:
    """What holds writes it; after a new entry run that chapter, commit results/claims.json."""
    assert [from_content(c) for c in recorded.claims()] == [computed(n) for n in identifiers()]


def test_the_recorded_ledger_keeps_to_its_schema() -> None:
    content = json.loads((ROOT / "results" / "claims.json").read_text(encoding="utf-8"))
    follows_schema(content, "claims", "lizarraga2025")
    content["claims"][0]["likeliest"] = "true"
    with pytest.raises(ValidationError):
        follows_schema(content, "claims", "lizarraga2025")


def test_every_entry_is_written_whatever_is_recorded(tmp_path: Path, monkeypatch) -> None:
    """A new statement has no record yet, and a record may be lost or of an older form."""
    file = tmp_path / "claims.json"
    monkeypatch.setattr("lizarraga2025.commands.claims.claim", computed)
    monkeypatch.setattr(recorded, "claims", lambda: 1 / 0)
    assert main(["claims", "--recompute", "--output", str(file)]) == 0
    written = json.loads(file.read_text(encoding="utf-8"))["claims"]
    assert [one["id"] for one in written] == list(identifiers())


@pytest.mark.parametrize("words", [["E-34", "--recompute"], ["--recompute", "--kind", "table"], []])
def test_a_file_of_claims_has_them_all(tmp_path: Path, capsys, words: list[str]) -> None:
    assert main(["claims", *words, "--output", str(tmp_path / "claims.json")]) == 2
    assert "--output writes every entry" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_holds_no_claims_is_not_replaced(tmp_path: Path, capsys) -> None:
    file = tmp_path / "letter.json"
    file.write_text("Dear reader", encoding="utf-8")
    assert main(["claims", "--recompute", "--output", str(file)]) == 2
    assert "holds no claims: it is not replaced" in capsys.readouterr().err
    assert file.read_text(encoding="utf-8") == "Dear reader"


# --- from outcome to verdict ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("outcome", "verdict"),
    [
        ({"holds": True}, "confirmed"),
        ({"holds": True, "constrains": False}, "vacuous"),
        ({"holds": False, "constrains": False}, "refuted"),
        ({"holds": True, "under": True, "corrected": True}, "confirmed"),
        ({"holds": False, "under": True}, "confirmed with a condition"),
        ({"holds": False, "corrected": True, "amended": True}, "misprint"),
        ({"holds": False, "amended": True}, "needs correction"),
        ({"holds": False}, "refuted"),
    ],
)
def test_an_outcome_decides_the_verdict(outcome, verdict) -> None:
    assert judge(**outcome) == verdict


@pytest.mark.parametrize(
    ("fits", "verdict"),
    [
        ([True, True, False], "not determined by the text"),
        ([True, False], "confirmed with a condition"),
        ([False, False], "refuted"),
    ],
)
def test_the_readings_that_fit_decide_the_verdict(fits, verdict) -> None:
    assert undetermined({str(i): fit for i, fit in enumerate(fits)}) == verdict


@pytest.mark.parametrize(
    ("readings", "verdict"),
    [
        (["refuted", "confirmed with a condition"], "confirmed with a condition"),
        (["vacuous", "refuted"], "vacuous"),
        (["refuted", "not determined by the text", "misprint"], "not determined by the text"),
        (["misprint", "refuted"], "misprint"),
        (["vacuous", "needs correction"], "needs correction"),
        (["refuted", "refuted"], "refuted"),
    ],
)
def test_the_kindest_reading_and_the_likeliest_have_a_verdict_and_all_are_told_where_they_differ(
    readings, verdict
) -> None:
    outcome = of_readings("Computed.", *((f"way {i}", r) for i, r in enumerate(readings)))
    assert (outcome.likeliest, outcome.most_favourable) == (readings[0], verdict)
    assert all(f"way {i}: {r}" in outcome.computed for i, r in enumerate(readings)) == (
        len(set(readings)) > 1
    )


def test_of_single_slips_in_table_4_the_proposed_digit_leaves_the_smallest_gap() -> None:
    gaps = slips_of_table_4()
    assert min(gaps, key=gaps.get) == "x_{2,13} = 9.09"
    assert {"x_{2,13} = 9.10", "x_{1,12} = 4.93", "z_{1,12} = 23.73"} <= gaps.keys()
    assert "x_{2,13} = 9.00" not in gaps


@pytest.mark.parametrize("proof", [proofs.theorem_2, proofs.mirror], ids=["theorem 2", "mirror"])
def test_every_step_of_a_proof_is_decided(proof) -> None:
    assert len(proof()) > 5
    assert set(proof().values()) == {True}


def test_the_decision_about_general_rotations_can_say_no() -> None:
    g = proofs.general()
    assert proofs.vanishes(g.R_0a @ g.R_0a.T - proofs.UNTURNED)
    assert not proofs.vanishes(g.R_0a - proofs.UNTURNED)
    assert not proofs.vanishes(g.R_0a @ g.R_ab - g.R_ab @ g.R_0a)


# --- commands -------------------------------------------------------------------------------------


def said(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str]:
    status = main(list(words))
    return status, capsys.readouterr().out


def test_claims_lists_a_kind_in_one_line_each(capsys) -> None:
    status, text = said(capsys, "claims", "--kind", "given")
    names = [line.split()[0] for line in text.splitlines()[:-2]]
    assert (status, names) == (0, [n for n in identifiers() if KIND[n] == "given"])
    assert text.splitlines()[-1] == f"together: {len(names)} entries, 0 findings"


def test_claims_of_a_verdict_have_their_numbers_and_tests(capsys) -> None:
    """What does not hold as printed is refuted or a misprint: both can be asked for at once."""
    status, text = said(capsys, "claims", "--verdict", "refuted", "--verdict", "misprint")
    wanted = [n for n in identifiers() if {*VERDICT[n]} & {"refuted", "misprint"}]
    assert status == 0
    assert re.findall(r"(?m)^(\S+)  \S", text) == wanted
    for name in wanted:
        assert f"  computed  {computed(name).computed}" in text
        assert computed(name).evidence.test in text


def test_an_id_may_be_typed_in_small_letters(capsys) -> None:
    assert said(capsys, "claims", "e-34") == said(capsys, "claims", "E-34")
    assert said(capsys, "claims", "th-2")[0] == 0


def test_claims_counts_entries_and_findings(capsys) -> None:
    _, text = said(capsys, "claims", "--kind", "bound")
    ledger = [computed(n) for n in identifiers() if KIND[n] == "bound"]
    assert text.splitlines()[-1] == (
        f"together: {len(ledger)} entries, {len({one.finding for one in ledger})} findings"
    )
    for verdict, count in counts(ledger).items():
        here = [one for one in ledger if one.likeliest == verdict]
        assert count == Count(len(here), len({one.finding for one in here}))
        assert f"{verdict}: {count.entries} entr" in text or not here


def test_claims_prints_an_entry_and_its_json(capsys) -> None:
    _, text = said(capsys, "claims", "E-34")
    assert computed("E-34").computed in text
    assert computed("E-34").reading in text
    _, text = said(capsys, "claims", "E-34", "E-37", "--json")
    entries = json.loads(text)["claims"]
    assert [from_content(entry) for entry in entries] == [computed("E-34"), computed("E-37")]


def test_claims_computes_an_entry_again_and_says_where_it_differs(capsys, monkeypatch) -> None:
    status, out = said(capsys, "claims", "E-9", "--recompute")
    assert (status, out.splitlines()[-1]) == (0, "computed again: 1, as recorded: 1")
    (entry,) = [content for content in recorded.claims() if content["id"] == "E-9"]
    other = entry | {"computed": "Something else."}
    monkeypatch.setattr(recorded, "claims", lambda: [other])
    status, out = said(capsys, "claims", "E-9", "--recompute")
    *_, first, second, third, fourth = out.splitlines()
    assert (status, first) == (1, "computed again: 1, as recorded: 0")
    assert second == "E-9 differs from what is recorded:"
    assert third == "  computed  recorded 'Something else.'"
    assert fourth == f"            now      {entry['computed']!r}"
    monkeypatch.setattr(recorded, "claims", lambda: [entry | {"likeliest": "confirmed"}])
    assert said(capsys, "claims", "E-9", "--recompute")[0] == 1
    assert "computed again" not in said(capsys, "claims", "E-9")[1]


def test_without_the_engine_the_error_names_it(capsys, monkeypatch) -> None:
    def missing(name: str) -> None:
        raise ModuleNotFoundError("No module named 'cspace'", name="cspace")

    monkeypatch.setattr("lizarraga2025.commands.claims.claim", missing)
    assert main(["claims", "E-34", "--recompute"]) == 2
    error = capsys.readouterr().err
    assert error.startswith(
        "lizarraga2025: to compute E-34 again takes cspace, which is not installed"
    )
    assert len(error.splitlines()) == 1


def test_the_module_is_the_command(capsys) -> None:
    """``python -m lizarraga2025`` prints what ``lizarraga2025`` prints, under its name."""
    command = [sys.executable, "-m", "lizarraga2025", "claims"]
    done = subprocess.run([*command, "E-34"], capture_output=True, text=True, check=True)
    assert done.stdout == said(capsys, "claims", "E-34")[1]
    done = subprocess.run([*command, "--help"], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("usage: lizarraga2025 claims")


def test_an_unknown_entry_is_bad_input(capsys) -> None:
    assert main(["claims", "E-99"]) == 2
    assert "E-99" in capsys.readouterr().err


def test_results_are_found_by_id_by_chapter_and_by_both(capsys) -> None:
    region = json.loads((ROOT / "results" / "region.json").read_text(encoding="utf-8"))
    _, text = said(capsys, "results", "region/", "--json")
    entries = json.loads(text)
    assert [{k: v for k, v in e.items() if k != "chapter"} for e in entries] == region["results"]
    _, by_both = said(capsys, "results", "region/vertex.1")
    _, by_id = said(capsys, "results", "vertex.1")
    assert by_both in by_id
    assert "-94.07" in by_both


# --- citing ---------------------------------------------------------------------------------------


def test_an_entry_is_cited_with_version_verdict_and_anchor(capsys) -> None:
    _, both = said(capsys, "cite")
    assert cite.PAPER in both
    assert cite.package() in both
    _, text = said(capsys, "claims", "T-4.2", "--bibtex")
    (misc,) = re.findall(r"(?s)@misc\{.*", text)
    assert "qbound-T-4.2" in misc
    assert "note   = {Unpublished. qbound " in misc
    assert f"Likeliest reading: {VERDICT['T-4.2'][0]}" in misc
    _, text = said(capsys, "claims", "E-37", "--bibtex")
    one = computed("E-37")
    for part in (*VERDICT["E-37"], cite.escaped(one.reading), cite.escaped(one.corrected)):
        assert part in text
    for record in (cite.PAPER, cite.package(), misc):
        assert record.count("{") == record.count("}")


def test_who_signs_and_where_stands_in_an_entry_as_soon_as_it_is_known(monkeypatch) -> None:
    """Until then no field is half filled: no author, no address, no DOI, and "unpublished"."""
    fields = ("author", "url", "doi")
    assert not any(f"  {name} " in cite.entry(computed("T-4.2")) for name in fields)
    known = {"authors": ["Doe, Jané"], "pages": "https://example.org/book/", "doi": "10.1/2"}
    monkeypatch.setattr(cite, "published", lambda: known)
    text = cite.entry(computed("T-4.2"))
    for part in ("{Doe, Jan{\\'e}}", r"{https://example.org/book/claims.html\#t-4-2}", "{10.1/2}"):
        assert part in text
    assert "Unpublished" not in text


def test_the_book_and_the_command_cite_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    """The page is a committed file, which cannot name its commit."""
    monkeypatch.setattr(cite, "state", lambda: None)
    page = (ROOT / "book" / "cite.md").read_text(encoding="utf-8")
    assert cite.PAPER in page
    assert cite.package() in page
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert project["tool"]["qbound"]["released"].year == cite.YEAR


def test_anchors_are_unique_and_made_from_the_id() -> None:
    anchors = [from_content(content).anchor for content in recorded.claims()]
    assert len(set(anchors)) == len(anchors) == len(identifiers())
    assert isinstance(computed("B-2.1.2"), Claim)
    assert computed("B-2.1.2").anchor == "b-2-1-2"
