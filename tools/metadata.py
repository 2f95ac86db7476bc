"""Write version, day, address and DOI into the files by which archives know this repository.

These four change from release to release and come from pyproject.toml. All else in CITATION.cff,
.zenodo.json, codemeta.json and ro-crate-metadata.json is edited there; tests/test_metadata.py
compares it with pyproject.toml. The paragraph of SECURITY.md that says where to report and the
BibTeX entry of book/cite.md are written whole. `python3 run.py metadata` writes; with `--check` it
names the files that are out of date.

The DOI is the one for all versions; Zenodo makes the DOI of each record, so .zenodo.json has none.
"""

import json
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

Table = dict[str, Any]

ROOT = Path(__file__).resolve().parents[1]

FORMS = {
    "repository": re.compile(r"https://[^\s/]+(/[^\s/]+)+"),
    "doi": re.compile(r"10\.\d{4,9}/\S+"),
}
FIELDS = {
    "CITATION.cff": {
        "date-released": "day",
        "doi": "doi",
        "repository-code": "repository",
        "version": "version",
    },
    ".zenodo.json": {"publication_date": "day", "version": "version"},
    "codemeta.json": {
        "codeRepository": "repository",
        "datePublished": "day",
        "identifier": "doi_url",
        "issueTracker": "issues",
        "version": "version",
    },
    "ro-crate-metadata.json": {
        "datePublished": "released",  # RO-Crate asks for a day: that of the last release
        "identifier": "doi_url",
        "url": "repository",
        "version": "version",
    },
}
"""The keys of each file that are written, and the fact that each holds. Without it a key goes."""

MARKED = re.compile(r"(?s)(?<=<!-- written by run.py metadata -->\n).*?(?=<!-- end -->)")


class Wrong(Exception):
    """Error: pyproject.toml has facts that cannot be used."""


def read(pyproject: str) -> Table:
    """Return the facts by their names; one that is not known yet is an empty text."""
    content = tomllib.loads(pyproject)
    project, ours = content["project"], content["tool"]["qbound"]
    for key, form in FORMS.items():
        if ours[key] and not form.fullmatch(ours[key]):
            raise Wrong(f"pyproject.toml: [tool.qbound] {key} is no {key}: {ours[key]!r}")
    repository, doi, released = ours["repository"], ours["doi"], str(ours["released"])
    what = project["description"]
    return project | {
        "title": f"{project['name']}: {what[0].lower()}{what[1:]}",
        "released": released,
        "day": "" if ".dev" in project["version"] else released,  # none between releases
        "doi": doi,
        "doi_url": doi and f"https://doi.org/{doi}",
        "repository": repository,
        "issues": repository and f"{repository}/issues",
    }


def with_fields(name: str, text: str, facts: Table) -> str:
    """Return the text of a file with the facts of now."""
    wanted = {key: facts[fact] for key, fact in FIELDS[name].items()}
    if name.endswith(".cff"):
        kept = [line for line in text.splitlines() if line.partition(":")[0] not in wanted]
        return "\n".join([*kept, *(f'{k}: "{v}"' for k, v in wanted.items() if v)]) + "\n"
    content = json.loads(text)
    graph = content.get("@graph", [content])
    table = next(entity for entity in graph if entity.get("@id", "./") == "./")
    for key, value in wanted.items():
        table.pop(key, None)
        table |= {key: value} if value else {}
    if "related_identifiers" in table:
        links = [x for x in table["related_identifiers"] if x["relation"] != "isDerivedFrom"]
        home = {"identifier": facts["repository"], "scheme": "url", "resource_type": "software"}
        own = [home | {"relation": "isDerivedFrom"}] if facts["repository"] else []
        table["related_identifiers"] = links + own
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def where_to_report(facts: Table) -> str:
    """Return the paragraph of SECURITY.md."""
    if facts["repository"]:
        return f"Report it in private: {facts['repository']}/security/advisories/new\n"
    return (
        "This copy has no public address yet. Report it in private to the person you have\n"
        "the copy from, and not in a public place.\n"
    )


def bibtex(facts: Table) -> str:
    """Return the BibTeX entry of this version, as a block of code."""
    people = " and ".join(f"{{{author['name']}}}" for author in facts["authors"])
    fields = {"author": people, "title": facts["title"], "version": facts["version"]}
    fields |= {"year": facts["released"][:4], "doi": facts["doi"], "url": facts["repository"]}
    lines = ",\n".join(f"  {key:<7} = {{{value}}}" for key, value in fields.items() if value)
    return f"```bibtex\n@software{{qbound,\n{lines}\n}}\n```\n"


PARTS = {"SECURITY.md": where_to_report, "book/cite.md": bibtex}


def written(name: str, text: str, facts: Table) -> str:
    """Return the content that a file should have."""
    if name in FIELDS:
        return with_fields(name, text, facts)
    if not MARKED.search(text):
        raise Wrong(f"{name}: the marks around the part that is written are missing.")
    return MARKED.sub(lambda _: PARTS[name](facts), text)


def main(words: list[str], root: Path = ROOT) -> int:
    """Write what is out of date, or with --check name it; return the exit status."""
    try:
        facts = read((root / "pyproject.toml").read_text(encoding="utf-8"))
        texts = {name: (root / name).read_text(encoding="utf-8") for name in [*FIELDS, *PARTS]}
        new = {name: written(name, text, facts) for name, text in texts.items()}
    except (Wrong, OSError) as wrong:
        print(wrong, file=sys.stderr)
        return 2
    stale = sorted(name for name in new if new[name] != texts[name])
    if words == ["--check"]:
        if stale:
            told = ", ".join(stale)
            print(f"Out of date: {told}. Run `python3 run.py metadata`.", file=sys.stderr)
        return int(bool(stale))
    for name in stale:
        (root / name).write_text(new[name], encoding="utf-8", newline="\n")
    print(f"Written: {', '.join(stale)}." if stale else "All metadata are up to date.")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
