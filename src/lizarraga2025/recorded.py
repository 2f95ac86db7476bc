"""The book's results as recorded: read, not computed, from the package or from its repository.

A wheel carries a copy of ``results/``, made when it is built; in a working copy the folder itself
is read.
"""

import json
import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

LEDGER = "claims.json"

UNCERTAINTIES = "input_uncertainty.json"
"""What the printed digits leave open of each result: the draws of `uncertainty`."""

DRAWS = 200
"""Arms whose printed lengths are drawn within half a unit of their last digit."""

CHAPTERS = {
    "introduction": 1,
    "planar_robot": 2,
    "vector_labelling": 3,
    "theorem_1": 4,
    "boundary_functions": 5,
    "theorem_2": 6,
    "region": 7,
    "workspace": 8,
    "sampling": 9,
    "what_holds": 10,
    "bodies": 11,
    "exact_workspace": 13,
    "obstacles": 14,
    "proof": 15,
    "your_own_robot": 16,
    "three_joints": 18,
    "real_arm": 19,
    "many_robots": 20,
    "errata": 21,
    "theorem_1_proof": 22,
    "side_by_side": 23,
}
"""Numbers of the chapters, in the order of the book, appendices last; 12 and 17 were merged."""

MERGED = {"every_region": "bodies", "prismatic_joints": "your_own_robot"}
"""Former chapters: their results keep file and id, and another chapter records them."""

APPENDICES = ("errata", "theorem_1_proof", "side_by_side")
"""The chapters that are appendices."""

PAPER = (*(name for name, number in CHAPTERS.items() if number <= 10), *APPENDICES[:2])
"""The chapters about the paper: `qbound` is enough for them, the others need `cspace` too."""

HEAD = ("chapter", "version", "robots")
"""What an entry takes over from its file."""


def chapter_of(results: str) -> str:
    """Return the chapter that records a file of results.

    Examples
    --------
    >>> chapter_of("region"), chapter_of("every_region")
    ('region', 'bodies')
    """
    return MERGED.get(results, results)


def file_stem(chapter: str) -> str:
    """Return the name of a chapter's files, which its number begins.

    Raises
    ------
    KeyError
        If the book has no such chapter.
    """
    return f"{CHAPTERS[chapter]:02d}_{chapter}"


def called(chapter: str) -> str:
    """Return what the book calls a chapter.

    Examples
    --------
    >>> called("introduction"), called("proof"), called("errata")
    ('Chapter 1', 'Chapter 15', 'Appendix A')
    """
    if chapter in APPENDICES:
        return f"Appendix {chr(ord('A') + APPENDICES.index(chapter))}"
    return f"Chapter {CHAPTERS[chapter]}"


def folder() -> Traversable:
    """Return the folder of the recorded results.

    Raises
    ------
    FileNotFoundError
        If there is neither a copy in the package nor a repository around it.
    """
    packaged = resources.files("lizarraga2025") / "recorded_results"
    repository = Path(__file__).resolve().parents[2] / "results"
    for place in (packaged, repository):
        if place.is_dir():
            return place
    raise FileNotFoundError("this installation carries no recorded results")


def results() -> list[dict[str, Any]]:
    """Return every recorded number: all chapters' entries, each with its chapter's head.

    That is ``chapter``, ``version`` and ``robots``, a hash each.
    """
    names = sorted((*CHAPTERS, *MERGED), key=lambda n: (CHAPTERS[chapter_of(n)], n in MERGED))
    files = (folder() / f"{name}.json" for name in names)
    content = [json.loads(f.read_text(encoding="utf-8")) for f in files if f.is_file()]
    return [{**{key: c[key] for key in HEAD}, **entry} for c in content for entry in c["results"]]


def distinct(entries: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return each result once, as the first of the chapters that state it records it."""
    once: dict[str, dict[str, Any]] = {}
    for entry in entries:
        once.setdefault(entry["id"], entry)
    return list(once.values())


@cache
def _table(name: str) -> dict[str, Any]:
    """Return a file of the package: what is written down of results, by patterns of their ids."""
    file = resources.files("lizarraga2025") / name
    return tomllib.loads(file.read_text(encoding="utf-8"))


def sentences() -> dict[str, str]:
    """Return what results are, by patterns of their ids."""
    return _table("sentences.toml")


def robots_of(entry: Mapping[str, Any]) -> dict[str, str]:
    """Return the robots that one result is about, a hash each; a chapter may have more.

    Parameters
    ----------
    entry : mapping
        Of `results`.

    Raises
    ------
    ValueError
        If the chapter has several, and it is not written down which count.

    Examples
    --------
    >>> [found] = [each for each in results() if each["id"] == "areas.minervabot-v2-symmetric"]
    >>> len(found["robots"]), [*robots_of(found)]
    (3, ['minervabot-v2-symmetric'])
    """
    recorded: dict[str, str] = entry["robots"]
    if len(recorded) < 2:
        return recorded
    patterns = _table("robots.toml").get(entry["chapter"], {})
    pattern = _longest(patterns, entry["id"])
    if pattern is None:
        raise ValueError(f"{entry['id']}: it is not written down which robots it is about")
    parts = re.fullmatch(_as_expression(pattern), entry["id"])
    names = [name.format(*parts.groups() if parts else ()) for name in patterns[pattern]]
    return {name: recorded[name] for name in names}


@cache
def sentence(name: str) -> str:
    """Return what the result of an id is, in a sentence.

    Raises
    ------
    ValueError
        If nothing is said of it.

    Examples
    --------
    >>> sentence("component.2.area")
    'Area of component 2 by the clearance rule, the largest but that of home first.'
    """
    parts = re.fullmatch(_as_expression(pattern_of(name)), name)
    return sentences()[pattern_of(name)].format(*parts.groups() if parts else ())


@cache
def pattern_of(name: str) -> str:
    """Return the pattern of ``sentences.toml`` that counts for an id."""
    pattern = _longest(sentences(), name)
    if pattern is None:
        raise ValueError(f"{name}: no sentence says what this result is")
    return pattern


def _longest(patterns: Iterable[str], name: str) -> str | None:
    """Return the longest pattern that fits an id."""
    fitting = (p for p in patterns if re.fullmatch(_as_expression(p), name))
    return max(fitting, key=len, default=None)


def _as_expression(pattern: str) -> str:
    """Return the expression of an id with stars, each of which stands for something."""
    return "(.+)".join(map(re.escape, pattern.split("*")))


def claims() -> list[dict[str, Any]]:
    """Return every recorded entry of the ledger.

    Raises
    ------
    FileNotFoundError
        If the ledger has not been written.
    """
    file = folder() / LEDGER
    if not file.is_file():
        raise FileNotFoundError(f"no {LEDGER} among the recorded results")
    entries: list[dict[str, Any]] = json.loads(file.read_text(encoding="utf-8"))["claims"]
    return entries


@cache
def input_uncertainties() -> dict[str, dict[str, Any]]:
    """Return what the printed digits leave open of the results that were studied, by their ids.

    Examples
    --------
    >>> area = input_uncertainties()["paper.area"]
    >>> area["input_uncertainty"], area["without_misprint"] > area["draws_to"]
    (0.022, True)
    """
    content = json.loads((folder() / UNCERTAINTIES).read_text(encoding="utf-8"))
    return {entry["id"]: entry for entry in content["quantities"]}


def about(entry: Mapping[str, Any]) -> str:
    """Return what a result belongs to in the paper, and the rule of its region: both may be ""."""
    rule = "" if entry["reading"] == "none" else f"{entry['reading']} rule"
    return ", ".join(filter(None, (entry["reference"], rule)))


def left_open(entry: Mapping[str, Any]) -> list[str]:
    """Return in words what the draws show of a result, beside its `input_uncertainty`.

    Examples
    --------
    >>> left_open({"id": "paper.area"})[-1]
    'with 9.09 for 9.00 it is 11.8597'
    >>> left_open({"id": "clearance.0.08.components"})
    ['3 in 56 % of the draws, 5 in 44 %']
    """
    studied, words = input_uncertainties().get(entry["id"], {}), []
    if len(shares := studied.get("shares", {})) > 1:
        (first, share), *others = ((name, f"{100 * part:.3g} %") for name, part in shares.items())
        words.append(", ".join([f"{first} in {share} of the draws", *map(" in ".join, others)]))
    if "another_boundary" in studied:
        part = 100 * studied["another_boundary"]
        words.append(f"another boundary decides in {part:.3g} % of the draws")
    if "without_misprint" in studied:
        value = json.dumps(_six_digits(studied["without_misprint"]))
        words.append(f"with 9.09 for 9.00 it is {value}")
    return words


def _six_digits(value: Any) -> Any:
    if isinstance(value, list):
        return [_six_digits(one) for one in value]
    return float(f"{value:.6g}")


def with_uncertainty(entry: Mapping[str, Any], unit: str = "") -> str:
    """Return a number with the digits that the printed ones allow, and without the misprint.

    Examples
    --------
    >>> [area] = [one for one in distinct(results()) if one["id"] == "paper.area"]
    >>> with_uncertainty(area, " rad²")
    '11.75 ± 0.02 rad²; with the other digit 11.86'
    """
    bound = entry["input_uncertainty"]
    if not bound:
        raise ValueError(f"{entry['id']}: no printed digit is known to leave it open")
    places = max(0, -math.floor(math.log10(bound)))
    text = f"{entry['value']:.{places}f} ± {bound:.{places}f}{unit}"
    other = input_uncertainties()[entry["id"]].get("without_misprint")
    return text if other is None else f"{text}; with the other digit {other:.{places}f}"
