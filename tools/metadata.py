"""Write the files by which archives and reference managers know this repository.

CITATION.cff, .zenodo.json, codemeta.json, ro-crate-metadata.json, the paragraph of SECURITY.md that
says where to report and the BibTeX entry of book/cite.md come from `[project]` and `[tool.qbound]`
of pyproject.toml alone, because facts that are kept by hand in several files drift apart.
`python3 run.py metadata` writes them; with `--check` it names the files that are out of date.

The DOI is the one for all versions; Zenodo makes the DOI of each record, so .zenodo.json has none.
CITATION.cff has no word for the relation to the paper, so a note says it.
"""

import json
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

Table = dict[str, Any]

ROOT = Path(__file__).resolve().parents[1]

ADDRESS = re.compile(r"https://[^\s/]+(/[^\s/]+)+")
DOI = re.compile(r"10\.\d{4,9}/\S+")

PARTS = {
    "src/": "The library qbound and lizarraga2025, the companion of the paper",
    "notebooks/": "The chapters of the book, before they are executed",
    "book/": "The pages of the book that are no notebooks, and its configuration",
    "results/": "Every number of the book, one JSON file a chapter",
    "tests/": "The tests",
    "docs/": "How the code is built, and the reasons for the main choices",
    "run.py": "The one command: makes the book, runs the tests, writes this file",
    "requirements.lock": "Every package that the book is computed with, by version and hash",
}
"""What the crate names of the repository, and what it says of it."""

MEDIA = {".py": "text/x-python", ".lock": "text/plain", ".json": "application/json"}
VERDICTS = "results/claims.json"  # the review of the paper, sentence by sentence


class Wrong(Exception):
    """What pyproject.toml says cannot be used."""


# --- what is known --------------------------------------------------------------------------------


def read(pyproject: str) -> Table:
    """Return what the files say: the project, its address and DOI if it has them, the paper."""
    content = tomllib.loads(pyproject)
    project: Table = content["project"]
    ours: Table = content["tool"]["qbound"]
    for key, form in (("repository", ADDRESS), ("doi", DOI)):
        if ours[key] and not form.fullmatch(ours[key]):
            raise Wrong(f"pyproject.toml: [tool.qbound] {key} is no {key}: {ours[key]!r}")
    what = project["description"]
    # A version between releases has no day of its own.
    own = {"day": "" if ".dev" in project["version"] else str(ours["released"])}
    return project | ours | own | {"full_title": f"{project['name']}: {what[0].lower()}{what[1:]}"}


def known(table: Table) -> Table:
    """Leave out what has no value yet: no file holds a placeholder."""
    return {key: value for key, value in table.items() if value not in ("", None)}


def doi_url(doi: str) -> str:
    return f"https://doi.org/{doi}" if doi else ""


def below(repository: str, path: str) -> str:
    return f"{repository}/{path}" if repository else ""


def names(author: str) -> tuple[str, str]:
    """Return family and given names of "Family, Given"."""
    family, given = author.split(", ")
    return family, given


# --- CITATION.cff ---------------------------------------------------------------------------------


def citation(about: Table) -> Table:
    return known(
        {
            "cff-version": "1.2.0",
            "message": "If you use qbound or its results, please cite it as below, "
            "and the paper that it reviews.",
            "type": "software",
            "title": about["full_title"],
            "abstract": about["abstract"],
            "version": about["version"],
            "date-released": about["day"] and about["released"],
            "doi": about["doi"],
            "license": about["license"],
            "repository-code": about["repository"],
            "authors": [{"name": author["name"]} for author in about["authors"]],
            "keywords": about["keywords"],
            "references": [reference(about["paper"])],
        }
    )


def reference(paper: Table) -> Table:
    people = [names(author) for author in paper["authors"]]
    return {
        "type": "article",
        "notes": "The paper that this software reviews.",
        "title": paper["title"],
        "authors": [{"family-names": family, "given-names": given} for family, given in people],
        "journal": paper["journal"],
        "volume": paper["volume"],
        "issue": paper["issue"],
        "start": paper["article"],
        "year": paper["year"],
        "month": paper["month"],
        "doi": paper["doi"],
        "url": doi_url(paper["doi"]),
        "license": paper["license"],
    }


def yaml(value: Any) -> Iterator[str]:
    """Yield the lines of a table or list: texts in quotes, as JSON has them, which YAML reads."""
    for key, item in value.items() if isinstance(value, dict) else ((None, one) for one in value):
        nested = isinstance(item, dict | list)
        lines = list(yaml(item)) if nested else [scalar(item)]
        if key is None:
            yield f"- {lines[0]}"
            yield from (f"  {line}" for line in lines[1:])
        elif nested:
            yield f"{key}:"
            yield from (f"  {line}" for line in lines)
        else:
            yield f"{key}: {lines[0]}"


def scalar(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else str(value)


# --- .zenodo.json ---------------------------------------------------------------------------------


def zenodo(about: Table) -> Table:
    """Return what Zenodo reads at a release. The record's own DOI is Zenodo's to give."""
    paper = about["paper"]
    article = {"identifier": paper["doi"], "scheme": "doi", "resource_type": "publication-article"}
    related = [article | {"relation": relation} for relation in about["relations"]]
    if about["repository"]:
        home = {"identifier": about["repository"], "scheme": "url", "resource_type": "software"}
        related.append(home | {"relation": "isDerivedFrom"})
    table = {
        "title": about["full_title"],
        "upload_type": "software",
        "version": about["version"],
        "publication_date": about["day"],
        "description": f"<p>{about['abstract']}</p><p>Code: {about['license']}. "
        f"Text and figures: {about['text_license']}.</p>",
        "creators": [{"name": author["name"]} for author in about["authors"]],
        "license": about["license"],
        "access_right": "open",
        "language": "eng",
        "keywords": about["keywords"],
        "related_identifiers": related,
    }
    return known(table)


# --- codemeta.json and the RO-Crate ---------------------------------------------------------------


def spdx(name: str) -> str:
    return f"https://spdx.org/licenses/{name}"


def article(paper: Table) -> Table:
    """Return the paper in the words of schema.org."""
    return {
        "@id": doi_url(paper["doi"]),
        "@type": "ScholarlyArticle",
        "name": paper["title"],
        "datePublished": f"{paper['year']}-{paper['month']:02}",
    }


def codemeta(about: Table) -> Table:
    authors = [
        {"@type": "Person", "familyName": family, "givenName": given}
        for family, given in map(names, about["paper"]["authors"])
    ]
    kind = {"@type": "schema:ScholarlyArticle"}  # CodeMeta's own list of types has no articles
    paper = article(about["paper"]) | kind | {"author": authors}
    return known(
        {
            "@context": "https://w3id.org/codemeta/3.0",
            "@type": "SoftwareSourceCode",
            "name": about["name"],
            "description": about["abstract"],
            "version": about["version"],
            "datePublished": about["day"],
            "identifier": doi_url(about["doi"]),
            "license": spdx(about["license"]),
            "codeRepository": about["repository"],
            "issueTracker": below(about["repository"], "issues"),
            "author": [organization(author["name"]) for author in about["authors"]],
            "keywords": about["keywords"],
            "programmingLanguage": "Python",
            "runtimePlatform": f"Python {about['requires-python']}",
            "citation": paper,
        }
    )


def organization(name: str) -> Table:
    return {"@type": "Organization", "name": name}


def crate(about: Table) -> Table:
    """Return the RO-Crate 1.2: the repository, its parts, the paper, and the review of it.

    In schema.org a review is a thing of its own that names what it judges: here the
    file of verdicts.
    """
    maintainers = [organization(author["name"]) for author in about["authors"]]
    for entity in maintainers:
        entity["@id"] = "#" + entity["name"].replace(" ", "-")
    authors = [person(author) for author in about["paper"]["authors"]]
    paper = article(about["paper"]) | {"author": ids(authors)}
    code = licence(about["license"], "The licence of the code")
    text = licence(about["text_license"], "The licence of text and figures")
    review = part(VERDICTS, "What holds of the paper, statement by statement, with the evidence")
    review |= {"@type": ["File", "Review"], "itemReviewed": ids([paper])}
    parts = [*(part(path, says) for path, says in PARTS.items()), review]
    root = {
        "@id": "./",
        "@type": "Dataset",
        "name": about["full_title"],
        "description": about["abstract"],
        "version": about["version"],
        "datePublished": str(
            about["released"]
        ),  # RO-Crate asks for a day: that of the last release
        "identifier": doi_url(about["doi"]),
        "url": about["repository"],
        "license": ids([code, text]),
        "author": ids(maintainers),
        "publisher": ids(maintainers),
        "keywords": about["keywords"],
        "hasPart": ids(parts),
        "citation": ids([paper]),
    }
    itself = {
        "@id": "ro-crate-metadata.json",
        "@type": "CreativeWork",
        "conformsTo": {"@id": "https://w3id.org/ro/crate/1.2"},
        "about": ids([root]),
    }
    graph = [itself, root, *parts, paper, *authors, *maintainers, code, text]
    return {
        "@context": "https://w3id.org/ro/crate/1.2/context",
        "@graph": [known(entity) for entity in graph],
    }


def ids(entities: list[Table]) -> Table | list[Table]:
    """Return references to entities: a list, but for one alone."""
    found = [{"@id": entity["@id"]} for entity in entities]
    return found[0] if len(found) == 1 else found


def person(author: str) -> Table:
    family, given = names(author)
    return {
        "@id": f"#{family}",
        "@type": "Person",
        "name": f"{given} {family}",
        "familyName": family,
        "givenName": given,
    }


def licence(name: str, what: str) -> Table:
    return {"@id": spdx(name), "@type": "CreativeWork", "name": name, "description": what}


def part(path: str, says: str) -> Table:
    found = {"@id": path, "@type": "Dataset", "name": path, "description": says}
    suffix = Path(path).suffix
    return found | ({"@type": "File", "encodingFormat": MEDIA[suffix]} if suffix else {})


# --- parts of texts: SECURITY.md, book/cite.md ---------------------------------------------------

MARKED = re.compile(r"(?s)(?<=<!-- written by run.py metadata -->\n).*?(?=<!-- end -->)")


def with_part(file: Path, part: str) -> str:
    """Return a file's text with a new part between the marks."""
    text = file.read_text(encoding="utf-8")
    if not MARKED.search(text):
        raise Wrong(f"{file.name}: the marks around the part that is written are missing.")
    return MARKED.sub(lambda _: part, text)


def where_to_report(repository: str) -> str:
    if repository:
        return f"Report it in private: {below(repository, 'security/advisories/new')}\n"
    return (
        "This copy has no public address yet. Report it in private to the person you have\n"
        "the copy from, and not in a public place.\n"
    )


def bibtex(about: Table) -> str:
    """Return the BibTeX entry of this version, as a block of code."""
    people = " and ".join(f"{{{author['name']}}}" for author in about["authors"])
    year = str(about["released"])[:4]
    fields = {"author": people, "title": about["full_title"], "version": about["version"]}
    fields |= {"year": year, "doi": about["doi"], "url": about["repository"]}
    lines = ",\n".join(f"  {key:<7} = {{{value}}}" for key, value in known(fields).items())
    return f"```bibtex\n@software{{qbound,\n{lines}\n}}\n```\n"


# --- writing and checking -------------------------------------------------------------------------


def files(root: Path) -> dict[Path, str]:
    """Return what each file should hold."""
    about = read((root / "pyproject.toml").read_text(encoding="utf-8"))
    advice, cite = root / "SECURITY.md", root / "book" / "cite.md"
    tables = {".zenodo.json": zenodo, "codemeta.json": codemeta, "ro-crate-metadata.json": crate}
    note = "# Written by `python3 run.py metadata` from pyproject.toml.\n"
    return {
        root / "CITATION.cff": note + "\n".join(yaml(citation(about))) + "\n",
        advice: with_part(advice, where_to_report(about["repository"])),
        cite: with_part(cite, bibtex(about)),
        **{
            root / name: json.dumps(make(about), indent=2, ensure_ascii=False) + "\n"
            for name, make in tables.items()
        },
    }


def is_fresh(file: Path, text: str) -> bool:
    return file.exists() and file.read_text(encoding="utf-8") == text


def main(words: list[str], root: Path = ROOT) -> int:
    try:
        stale = {file: text for file, text in files(root).items() if not is_fresh(file, text)}
    except Wrong as wrong:
        print(wrong, file=sys.stderr)
        return 2
    told = ", ".join(sorted(file.name for file in stale))
    if words == ["--check"]:
        if stale:
            print(f"Out of date: {told}. Run `python3 run.py metadata`.", file=sys.stderr)
        return int(bool(stale))
    for file, text in stale.items():
        file.write_text(text, encoding="utf-8", newline="\n")
    print(f"Written: {told}." if stale else "All metadata are up to date.")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
