"""The chapters: pairs in step, numbers of the prose computed, results the same as committed."""

from __future__ import annotations

import ast
import json
import math
import re
import subprocess
import sys
from collections import Counter
from functools import cache
from pathlib import Path

import jupytext
import pytest
from jupytext.compare import compare_notebooks

from engine_support.commands import follows_schema
from lizarraga2025 import printed as paper
from lizarraga2025 import recorded
from lizarraga2025.results import share_of_error

ROOT = Path(__file__).resolve().parents[2]
CHAPTERS = sorted((ROOT / "notebooks").glob("[0-9]*.md"))
LEDGER = ROOT / "results" / "claims.json"  # compared in test_claims.py
NOT_OF_A_CHAPTER = {LEDGER, ROOT / "results" / recorded.UNCERTAINTIES}
RESULTS = sorted(set((ROOT / "results").glob("*.json")) - NOT_OF_A_CHAPTER)

chapters = pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda path: path.stem)


@cache
def notebook(path: Path):
    return jupytext.read(path)


def cells(path: Path, kind: str) -> list:
    return [cell for cell in notebook(path).cells if cell.cell_type == kind]


# --- pairs ----------------------------------------------------------------------------------------


def test_every_chapter_is_a_pair():
    stems = {path.stem for path in (ROOT / "notebooks").iterdir() if path.suffix == ".ipynb"}
    assert stems == {path.stem for path in CHAPTERS}
    assert sorted(stems) == [recorded.file_stem(name) for name in recorded.CHAPTERS]


@chapters
def test_a_pair_is_in_step_and_holds_no_output(chapter):
    pair = notebook(chapter.with_suffix(".ipynb")), notebook(chapter)
    compare_notebooks(*pair, fmt="md:myst")
    assert [file.metadata["jupytext"]["formats"] for file in pair] == ["ipynb,md:myst"] * 2
    code = cells(chapter.with_suffix(".ipynb"), "code")
    assert [cell for cell in code if cell.outputs or cell.execution_count is not None] == []


@chapters
def test_a_chapter_teaches_then_audits_then_asks(chapter):
    """Appendices only open with their question: they are audits themselves."""
    text = chapter.read_text(encoding="utf-8")
    assert ":::{admonition} Question" in text.split("```{code-cell}")[0]
    parts = ["Answer", "Exercises"]
    if chapter.stem < "11":
        parts.insert(1, "Against the print")
    if chapter.stem[3:] not in recorded.APPENDICES:
        assert re.findall(r"^## (.*)$", text, re.M)[-len(parts) :] == parts


KEPT = json.loads((ROOT / "tests" / "book" / "kept.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("stem", KEPT)
def test_a_chapter_on_the_small_library_keeps_what_can_be_cited(stem):
    """Captions, alternative texts, labels, exercises: counted before cells were rewritten."""
    text = (ROOT / "notebooks" / f"{stem}.md").read_text(encoding="utf-8")
    patterns = {
        "names": r"^    name: ([\w:-]+)$",
        "equations": r"^\$\$ *\((eq:[\w-]+)\)$",
        "captions": r"^    caption:",
        "alternative texts": r"^    alt:",
        "exercises": r"^\*\*Exercise \d+\.\*\*",
        "checked exercises": r"\bcheck\(",
    }
    found = {key: re.findall(pattern, text, re.M) for key, pattern in patterns.items()}
    for key, before in KEPT[stem].items():
        assert (found[key] if isinstance(before, list) else len(found[key])) == before, key


ALONE = """
import sys
sys.modules["cspace"] = None  # whoever imports it fails
for line in sys.stdin.read().splitlines():
    exec(line)
print(*sorted(name for name in sys.modules if name.partition(".")[0] == "cspace"))
"""


@pytest.mark.parametrize("name", recorded.PAPER)
def test_a_chapter_about_the_paper_loads_no_module_of_the_engine(name):
    """All its imports, in a fresh interpreter; CI executes these chapters without the engine."""
    chapter = ROOT / "notebooks" / f"{recorded.file_stem(name)}.md"
    trees = [ast.parse(cell.source) for cell in cells(chapter, "code")]
    found = [node for tree in trees for node in ast.walk(tree)]
    lines = [ast.unparse(n) for n in found if isinstance(n, ast.Import | ast.ImportFrom)]
    assert any("qbound" in line for line in lines)
    command = [sys.executable, "-W", "error", "-c", ALONE]
    text = "\n".join(lines)
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.split()) == (0, ["cspace"]), done.stderr


# What is in sight teaches; the rest is folded (hide-input) or left out of the page (remove-cell).
FOLDED = {"hide-input", "hide-cell", "remove-input", "remove-cell"}
LONGEST_CELL = 12  # lines of code in sight


@chapters
def test_code_in_sight_is_short(chapter):
    """Imports are not counted: they stand together at the top."""
    for cell in cells(chapter, "code"):
        nodes = ast.parse(cell.source).body
        imports = [n for n in nodes if isinstance(n, ast.Import | ast.ImportFrom)]
        hidden = {line for n in imports for line in range(n.lineno, n.end_lineno + 1)}
        lines = [
            s for k, s in enumerate(cell.source.splitlines(), 1) if s.strip() and k not in hidden
        ]
        if not FOLDED & set(cell.metadata.get("tags", [])):
            assert len(lines) <= LONGEST_CELL, f"{chapter.name}: {lines[0]}"


BOOKKEEPING = {"what_holds", *recorded.APPENDICES}


@chapters
def test_a_learners_page_has_no_ids_and_no_verdicts_in_its_text(chapter):
    """They stand in the folded box of each section, which the pages get from the claims."""
    if chapter.stem[3:] not in BOOKKEEPING:
        text = "\n".join(cell.source for cell in cells(chapter, "markdown"))
        assert re.findall(r"\{verdict\}|\b(?:E|B|T|F|S|TH)-\d+", text) == []


@chapters
def test_results_are_recorded_in_one_hidden_cell_at_the_end(chapter):
    """So it can run twice: the collection is made where it is filled."""
    recording = [c for c in cells(chapter, "code") if re.search(r"\bresults\.|Results\(", c.source)]
    assert recording == [cells(chapter, "code")[-1]] == [notebook(chapter).cells[-1]]
    [cell] = recording
    assert "remove-cell" in cell.metadata["tags"]
    assert cell.metadata["jupyter"] == {"source_hidden": True}


@chapters
def test_every_box_is_closed_in_its_cell(chapter):
    """An open one swallows what follows: an exercise stood in the solution before it."""
    for cell in cells(chapter, "markdown"):
        opened = re.findall(r"^:::+\{", cell.source, re.M)
        assert len(opened) == len(re.findall(r"^:::+$", cell.source, re.M)), cell.source[:80]


@chapters
def test_half_of_the_exercises_run(chapter):
    text = chapter.read_text(encoding="utf-8")
    section = text.partition("\n## Exercises\n")[2].partition("\n## ")[0]
    if section:
        tasks = len(re.findall(r"^\*\*Exercise \d+\.\*\*", section, re.M))
        assert tasks >= 2
        assert section.count("check(") * 2 >= tasks


@chapters
def test_a_reference_to_the_paper_is_a_link(chapter):
    text = "\n\n".join(cell.source for cell in cells(chapter, "markdown"))
    text = re.sub(r"(?s)```.*?```|`[^`]*`|\[[^\]]*\]\([^)]*\)|(?m:^#[^\n]*$)", " ", text)
    assert re.findall(r"\b(?:eqs?\. \(\d+|Tables? \d|Figures? \d+|Theorem [12]\b)", text) == []


# --- numbers in prose -----------------------------------------------------------------------------

NOT_PROSE = [
    r"(?s)```.*?```",  # code
    r"(?s)\$\$.*?\$\$(?: *\(eq:[\w-]+\))?",  # displayed formulas: the paper's, or proved by a cell
    r"(?m)^:::.*$|^:label:.*$|^(?:# )?\d+\. ",  # directives, numbered items and titles
    r"`[^`]*`",  # code and the targets of roles
    r"<div[^>]*>",  # places of the moving figures
    r"\[\d+\]\(#[^)]*\)",  # a reference, such as the second one of "Figures 6 to 10"
    r"\]\([^)]*\)",  # targets of links
    r"\b(?:E|B|T|F|S|TH)-\d+(?:\.\d+)*\b|\bN\d\b|SO\(3\)|3-D",  # the ledger's ids, own numbers
]
# What a number may name instead of count: Figure 4, eqs. (11), (12), points 6 and 8, point 1 to 2.
NAMED = (
    r"(?:Figures?|Tables?|Theorems?|Sections?|eqs?\.|[Pp]oints?|[Jj]oints?|[Ll]inks?|[Rr]ows?|[Rr]ules?|"
    r"[Cc]hapters?|[Ss]teps?|Exercises?|[Rr]egions?|functions?|[Ff]rom|CC BY)\s+"
)
NUMBERS = r"\(?\d+(?:\.\d+)?\)?(?:(?:,\s+|\s+(?:and|or|to|with)\s+|\s*-\s*)\(?\d+(?!\.\d|\d)\)?)*"
REFERENCES = [NAMED + NUMBERS, r"\(\d+\)(?:-\(\d+\))?", r"\b\d(?:-\d){2,}\b"]
NUMBER = r"(?<![\w.])[-−]?\d+(?:\.\d+)?(?![\w.]*\d)"


def captions_of(chapter: Path) -> list[str]:
    """Captions and alternative texts of the figures and tables."""
    blocks = [cell.metadata.get("mystnb", {}) for cell in cells(chapter, "code")]
    captions = [block.get("figure", {}).get("caption", "") for block in blocks]
    return captions + [block.get("image", {}).get("alt", "") for block in blocks]


def prose_of(chapter: Path) -> str:
    """Markdown cells and captions, without what is no prose."""
    markdown = (cell.source for cell in cells(chapter, "markdown"))
    text = "\n\n".join([*markdown, *captions_of(chapter)])
    text = re.sub(r"(?s)```\{prf:\w+\}[^\n]*\n(.*?)\n```", r"\1", text)  # a theorem is prose
    for pattern in NOT_PROSE:
        text = re.sub(pattern, " ", text)
    return text


def numbers_in(prose: str) -> list[str]:
    """Numbers that claim a value: all outside formulas, decimal ones inside."""
    inside = re.findall(r"\$([^$]*)\$", prose)
    outside = re.sub(r"\$[^$]*\$", " X ", prose)
    for pattern in REFERENCES:
        outside = re.sub(pattern, " ", outside)
    decimals = [n for formula in inside for n in re.findall(NUMBER, formula) if "." in n]
    return [n.replace("−", "-") for n in re.findall(NUMBER, outside)] + decimals


def leaves(value) -> list[float]:
    if isinstance(value, list):
        return [leaf for item in value for leaf in leaves(item)]
    return [] if isinstance(value, str) else [float(value)]


def results_of(chapter: Path) -> list[Path]:
    """The files that it records: those of chapters that were merged into it, too."""
    names = re.findall(r'Results\(\s*"(\w+)"', chapter.read_text(encoding="utf-8"))
    return [ROOT / "results" / f"{name}.json" for name in names]


def entries_of(chapter: Path) -> list[dict]:
    contents = [json.loads(file.read_text(encoding="utf-8")) for file in results_of(chapter)]
    return [entry for content in contents for entry in content["results"]]


def is_written_out(entry: dict) -> bool:
    """Tell whether a result is one number in more digits than a double holds."""
    return entry["id"].endswith(".digits") and isinstance(entry["value"], str)


def known_to(chapter: Path) -> list[float]:
    """What the chapter computed, and the printed offsets."""
    entries = entries_of(chapter)
    computed = [x for entry in entries for x in leaves(entry["value"])]
    computed += [float(entry["value"]) for entry in entries if is_written_out(entry)]
    computed += [x for entry in entries for x in left_open(entry)]
    return computed + [offset.value for offset in paper.OFFSETS]


def left_open(entry: dict) -> list[float]:
    """What the draws of printed digits show of a result; whole numbers where it is open by one."""
    studied, bound = recorded.input_uncertainties().get(entry["id"], {}), entry["input_uncertainty"]
    ends = [studied[k] for k in ("draws_from", "draws_to", "without_misprint") if k in studied]
    found = [*leaves(ends), bound or 0.0, float(recorded.DRAWS)]
    if bound and bound >= 1:
        found += [float(round(x)) for x in [*leaves(entry["value"]), *leaves(ends), bound]]
    return found + [100 * share for share in studied.get("shares", {}).values()]


def is_rounding(text: str, value: float) -> bool:
    """Tell whether a number of the text is a value rounded to the text's digits, sign aside."""
    digits = len(text.partition(".")[2])
    if digits == 0:
        return math.isclose(abs(value), abs(float(text)))
    return f"{abs(value):.{digits}f}" == text.lstrip("-")


BOUNDS = {"above": "at most|no more than|less than|within", "below": "at least|more than"}
"""Words that make a number a bound of what was computed: from above, from below.

The first of each may also stand behind the number.
"""


def bounds_in(prose: str) -> list[tuple[str, str]]:
    """Numbers that a phrase before or behind them ("1° at most") calls a bound, and its side."""
    outside = re.sub(r"\$[^$]*\$", " X ", prose)
    found = [
        (before or behind, side)
        for side, words in BOUNDS.items()
        for before, behind in re.findall(
            rf"(?:{words})\s+({NUMBER})|({NUMBER})\S*\s+(?:\w+\s+)?{words.partition('|')[0]}\b",
            outside,
        )
    ]
    return [(number.replace("−", "-"), side) for number, side in found]


def is_safe(text: str, side: str, value: float) -> bool:
    """Tell whether a number of the text is a value rounded away from it to the given side."""
    beyond = abs(float(text)) - abs(value)
    place = 10.0 ** -len(text.partition(".")[2])
    return -1e-12 < (beyond if side == "above" else -beyond) < place


@chapters
def test_every_number_of_the_prose_was_computed(chapter):
    known = known_to(chapter)
    stated = Counter(numbers_in(prose_of(chapter)))
    bounds = bounds_in(prose_of(chapter))
    stated -= Counter(number for number, _ in bounds)
    assert [n for n in stated if not any(is_rounding(n, x) for x in known)] == []
    assert [bound for bound in bounds if not any(is_safe(*bound, x) for x in known)] == []


UNITS = {"°": "deg", "cm²": "cm^2", "rad²": "rad^2", "cm": "cm", "mm": "mm", "m": "m", "%": "%"}


def measures_in(caption: str) -> list[tuple[str, str]]:
    """Numbers that stand before a unit, with their sign and the unit as results write it."""
    with_unit = rf"({NUMBER})\s?({'|'.join(UNITS)})(?!\w)"
    return [(n.replace("−", "-"), UNITS[unit]) for n, unit in re.findall(with_unit, caption)]


def is_measured(text: str, unit: str, entry: dict) -> bool:
    """Tell whether a result is this number, with its sign, in this unit."""
    here = entry["unit"] == unit
    return here and any(
        is_rounding(text, x) and x * float(text) >= 0 for x in leaves(entry["value"])
    )


@chapters
def test_a_number_with_a_unit_in_a_caption_was_computed_in_that_unit_with_that_sign(chapter):
    """In prose "0.41 cm too low" may stand for a negative value; a caption names what is drawn."""
    printed = {"unit": "cm", "value": list(paper.offsets_in_cm().values())}
    entries = [*entries_of(chapter), printed]
    stated = [pair for caption in captions_of(chapter) for pair in measures_in(caption)]
    assert [pair for pair in stated if not any(is_measured(*pair, e) for e in entries)] == []


def test_the_search_for_numbers_finds_them():
    """A caption said −90°, where the panel has 90; a bound is rounded to the safe side."""
    prose = "At 76.25° (Figure 4, eqs. (11), (12)) points 6 and 8 are $-1.5$ apart, 37 of $360$."
    assert numbers_in(prose) == ["76.25", "37", "-1.5"]
    assert [is_rounding("0.96", x) for x in (0.9640384, 0.9660384)] == [True, False]
    bounds = bounds_in("within 0.0047 cm, 1.09° wide at most")
    assert bounds == [("0.0047", "above"), ("1.09", "above")]
    safe = [is_safe(text, "above", 1.0916) for text in ("1.09", "1.10", "1.11")]
    assert safe == [False, True, False]
    entry = {"unit": "deg", "value": [-90, 0, 45]}
    stated = measures_in("The wrist held at −90° and 90°, 45 times, at 45 cm.")
    assert [is_measured(*pair, entry) for pair in stated] == [True, False, False]


# --- results --------------------------------------------------------------------------------------


def committed(path: Path) -> dict:
    """Git's own copy: the run has rewritten the file."""
    name = path.relative_to(ROOT).as_posix()
    shown = subprocess.run(
        ["git", "show", f"HEAD:{name}"], cwd=ROOT, capture_output=True, check=False
    )
    if shown.returncode:
        pytest.skip(f"{name}: no committed copy to compare with (no git, or not committed yet)")
    return json.loads(shown.stdout)


@pytest.mark.parametrize("path", RESULTS, ids=lambda path: path.stem)
def test_results_keep_to_their_schema(path):
    follows_schema(json.loads(path.read_text(encoding="utf-8")), "results", "lizarraga2025")


def test_every_chapter_has_results():
    assert sorted(file for chapter in CHAPTERS for file in results_of(chapter)) == RESULTS


@pytest.mark.parametrize("path", RESULTS, ids=lambda path: path.stem)
def test_results_are_the_committed_ones(path):
    now, then = json.loads(path.read_text(encoding="utf-8")), committed(path)
    assert [entry["id"] for entry in now["results"]] == [entry["id"] for entry in then["results"]]
    for new, old in zip(now["results"], then["results"], strict=True):
        assert share_of_error(new, old) <= 1, new["id"]
