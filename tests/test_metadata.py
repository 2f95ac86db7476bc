"""What archives and reference managers read: made from pyproject.toml, and from nothing else."""

import json
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from lizarraga2025.ledger import cite
from support.scripts import load_script

ROOT = Path(__file__).resolve().parents[1]
PYPROJECT = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
PAPER = tomllib.loads(PYPROJECT)["tool"]["qbound"]["paper"]
DATA = ["CITATION.cff", ".zenodo.json", "codemeta.json", "ro-crate-metadata.json"]
NAMES = [*DATA, "SECURITY.md", "book/cite.md"]
HOME, OWN_DOI = "https://code.invented.net/someone/qbound", "10.9999/invented.1"

metadata = load_script("tools/metadata.py")


def pyproject(repository: str, doi: str) -> str:
    """The real pyproject.toml with an address and a DOI of our choice."""
    text = PYPROJECT
    for key, value in (("repository", repository), ("doi", doi)):
        text, count = re.subn(rf'(?m)^{key} = "(?!{PAPER["doi"]}).*"$', f'{key} = "{value}"', text)
        assert count == 1, key
    return text


def copy_texts(folder: Path) -> None:
    for name in NAMES:
        (folder / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, folder / name)


def written(folder: Path, repository: str, doi: str) -> dict[str, str]:
    """What `run.py metadata` writes in a copy."""
    folder.mkdir(exist_ok=True)
    (folder / "pyproject.toml").write_text(pyproject(repository, doi), encoding="utf-8")
    copy_texts(folder)
    assert metadata.main([], folder) == 0
    return {name: (folder / name).read_text(encoding="utf-8") for name in NAMES}


@pytest.fixture
def bare(tmp_path: Path) -> dict[str, str]:
    return written(tmp_path, "", "")


@pytest.fixture
def public(tmp_path: Path) -> dict[str, str]:
    return written(tmp_path, HOME, OWN_DOI)


def entities(text: str) -> dict[str, dict[str, Any]]:
    """The graph of an RO-Crate by its ids, which are unique."""
    graph = json.loads(text)["@graph"]
    found = {entity["@id"]: entity for entity in graph}
    assert len(found) == len(graph)
    return found


def values(tree: Any) -> Iterator[Any]:
    for item in tree.values() if isinstance(tree, dict) else tree:
        yield item
        if isinstance(item, dict | list):
            yield from values(item)


def of_version(folder: Path, version: str) -> dict[str, dict[str, Any]]:
    """What the tables say of a version."""
    folder.mkdir()
    text = re.sub(r'(?m)^version = ".*"$', f'version = "{version}"', pyproject(HOME, OWN_DOI))
    (folder / "pyproject.toml").write_text(text, encoding="utf-8")
    copy_texts(folder)
    assert metadata.main([], folder) == 0
    return {name: yaml.safe_load((folder / name).read_text(encoding="utf-8")) for name in DATA}


def test_a_version_between_releases_has_no_day(tmp_path: Path) -> None:
    """They said 0.3.0 and its day of states that came long after."""
    release = of_version(tmp_path / "release", "0.4.0")
    between = of_version(tmp_path / "between", "0.4.0.dev0")
    days = {"CITATION.cff": "date-released", ".zenodo.json": "publication_date"}
    for name, key in (days | {"codemeta.json": "datePublished"}).items():
        assert release[name]["version"] == "0.4.0"
        assert between[name]["version"] == "0.4.0.dev0"
        assert key in release[name]
        assert key not in between[name]


# --- one place ------------------------------------------------------------------------------------


def test_the_committed_files_are_what_pyproject_says() -> None:
    assert metadata.main(["--check"]) == 0


def test_what_is_kept_by_hand_is_what_pyproject_says() -> None:
    content = tomllib.loads(PYPROJECT)
    project, ours = content["project"], content["tool"]["qbound"]
    citation, zenodo, code, crate = (
        yaml.safe_load((ROOT / name).read_text(encoding="utf-8")) for name in DATA
    )
    graph = {entity["@id"]: entity for entity in crate["@graph"]}
    root, paper = graph["./"], f"https://doi.org/{PAPER['doi']}"
    title = metadata.read(PYPROJECT)["title"]
    assert citation["title"] == zenodo["title"] == root["name"] == title
    assert citation["abstract"] == code["description"] == root["description"] == ours["abstract"]
    assert ours["abstract"] in zenodo["description"]
    for table in (citation, zenodo, code, root):
        assert table["keywords"] == project["keywords"]
    assert citation["license"] == zenodo["license"] == project["license"]
    assert code["license"] == f"https://spdx.org/licenses/{project['license']}"
    assert [graph[each["@id"]]["name"] for each in root["license"]] == [
        project["license"],
        ours["text_license"],
    ]
    assert code["runtimePlatform"] == f"Python {project['requires-python']}"
    [maintainers] = [author["name"] for author in project["authors"]]
    assert citation["authors"] == zenodo["creators"] == [{"name": maintainers}]
    assert code["author"][0]["name"] == graph[root["author"]["@id"]]["name"] == maintainers
    people = PAPER["authors"]
    (cited,) = citation["references"]
    for key in ("title", "journal", "volume", "issue", "year", "month", "doi", "license"):
        assert cited[key] == PAPER[key], key
    assert cited["start"] == PAPER["article"]
    assert [f"{a['family-names']}, {a['given-names']}" for a in cited["authors"]] == people
    assert [f"{a['familyName']}, {a['givenName']}" for a in code["citation"]["author"]] == people
    authors = [graph[each["@id"]] for each in graph[paper]["author"]]
    assert [f"{a['familyName']}, {a['givenName']}" for a in authors] == people
    for article in (code["citation"], graph[paper]):
        assert (article["@id"], article["name"]) == (paper, PAPER["title"])
        assert article["datePublished"] == f"{PAPER['year']}-{PAPER['month']:02}"
    assert [link["relation"] for link in zenodo["related_identifiers"]] == ours["relations"]


@pytest.mark.parametrize("name", NAMES)
def test_a_file_that_was_edited_is_named(name: str, tmp_path: Path, capsys) -> None:
    written(tmp_path, HOME, "")
    text = (tmp_path / name).read_text(encoding="utf-8")
    (tmp_path / name).write_text(text.replace(HOME, "https://else.where.net/x"), encoding="utf-8")
    assert metadata.main(["--check"], tmp_path) == 1
    assert f"Out of date: {name}." in capsys.readouterr().err
    assert "else.where" in (tmp_path / name).read_text(encoding="utf-8")  # a check writes nothing
    assert metadata.main([], tmp_path) == 0
    assert (tmp_path / name).read_text(encoding="utf-8") == text


@pytest.mark.parametrize(
    ("repository", "doi", "named"),
    [
        ("http://code.invented.net/qbound", "", "repository"),
        ("https://code.invented.net/someone/qbound/", "", "repository"),
        ("someone/qbound", "", "repository"),
        ("", "https://doi.org/10.9999/invented.1", "doi"),
        ("", "10.9999", "doi"),
    ],
)
def test_what_is_no_address_and_no_doi_is_refused(
    repository: str, doi: str, named: str, tmp_path: Path, capsys
) -> None:
    (tmp_path / "pyproject.toml").write_text(pyproject(repository, doi), encoding="utf-8")
    copy_texts(tmp_path)
    assert metadata.main([], tmp_path) == 2
    assert f"[tool.qbound] {named} is no {named}" in capsys.readouterr().err
    same = (tmp_path / "CITATION.cff").read_text(encoding="utf-8")
    assert same == (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_the_paper_is_the_same_wherever_it_is_cited() -> None:
    """In BibTeX its letters are TeX's; everything else must be as in pyproject.toml."""
    accents = {"é": r"{\'e}", "á": r"{\'a}", "ó": r"{\'o}", "í": r"{\'i}"}
    bibliography = (ROOT / "book/references.bib").read_text(encoding="utf-8")
    families = [author.split(",")[0] for author in PAPER["authors"]]
    for record in (cite.PAPER, bibliography.split("\n}\n")[0]):
        assert f"{{{PAPER['title']}}}" in record
        assert f"{{{PAPER['doi']}}}" in record
        for key in ("journal", "volume", "year"):
            assert re.search(rf"{key}\s*= \{{{PAPER[key]}\}}", record), key
        assert re.search(rf"number\s*= \{{{PAPER['issue']}\}}", record)
        assert re.search(rf"pages\s*= \{{{PAPER['article']}\}}", record)
        for family in families:
            assert "".join(accents.get(letter, letter) for letter in family) in record
        assert len(re.split(r"\sand\s", record.split("title")[0])) == len(families)


# --- the address and the DOI ----------------------------------------------------------------------


def test_an_invented_address_and_doi_are_everywhere(public: dict[str, str]) -> None:
    citation = yaml.safe_load(public["CITATION.cff"])
    assert (citation["repository-code"], citation["doi"]) == (HOME, OWN_DOI)
    code = json.loads(public["codemeta.json"])
    assert (code["codeRepository"], code["issueTracker"]) == (HOME, f"{HOME}/issues")
    assert code["identifier"] == f"https://doi.org/{OWN_DOI}"
    root = entities(public["ro-crate-metadata.json"])["./"]
    assert (root["url"], root["identifier"]) == (HOME, f"https://doi.org/{OWN_DOI}")
    assert f"{HOME}/security/advisories/new" in public["SECURITY.md"]
    assert f"doi     = {{{OWN_DOI}}},\n  url     = {{{HOME}}}\n}}" in public["book/cite.md"]
    # Zenodo gives its record a DOI itself; a foreign one there would stop it.
    related = json.loads(public[".zenodo.json"])["related_identifiers"]
    home = {"identifier": HOME, "scheme": "url", "resource_type": "software"}
    assert home | {"relation": "isDerivedFrom"} in related
    assert OWN_DOI not in public[".zenodo.json"]


@pytest.mark.parametrize("name", NAMES)
def test_without_them_nothing_stands_in_their_place(name: str, bare: dict[str, str]) -> None:
    text = bare[name]
    assert not re.search(r"(?i)todo|tbd|placeholder|example\.|github\.com|zenodo\.\d|xxx", text)
    assert set(re.findall(r"10\.\d{4,9}/[\w./]+\w", text)) <= {PAPER["doi"]}
    if name == "SECURITY.md":
        assert "no public address yet" in text
        assert "://" not in text
    if name in DATA:
        tree = yaml.safe_load(text)  # which reads JSON too
        assert not [value for value in values(tree) if value in ("", None, [], {})]
        assert not {"doi", "repository-code", "codeRepository", "issueTracker"} & set(tree)


@pytest.mark.parametrize(
    ("repository", "doi", "labels"),
    [("", "", ["Paper"]), (HOME, OWN_DOI, ["Paper", "DOI", "Repository", "Issues"])],
)
def test_the_wheel_carries_the_addresses_that_are_known(
    repository: str, doi: str, labels: list[str], tmp_path: Path
) -> None:
    """So that an installed package can name them: importlib.metadata reads them."""
    (tmp_path / "pyproject.toml").write_text(pyproject(repository, doi), encoding="utf-8")
    for name in ("setup.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, tmp_path)
    for name in ("src/qbound", "made"):
        (tmp_path / name).mkdir(parents=True)
    call = "import setuptools.build_meta as b; b.prepare_metadata_for_build_wheel('made')"
    subprocess.run([sys.executable, "-c", call], cwd=tmp_path, check=True, capture_output=True)
    [file] = tmp_path.glob("made/*.dist-info/METADATA")
    found = dict(re.findall(r"(?m)^Project-URL: (\w+), (\S+)$", file.read_text(encoding="utf-8")))
    assert list(found) == labels
    assert found["Paper"] == f"https://doi.org/{PAPER['doi']}"
    assert found.get("Repository", "") == repository
    assert found.get("DOI", "").removeprefix("https://doi.org/") == doi


# --- what the files say ---------------------------------------------------------------------------


def test_the_paper_is_reviewed_and_referred_to_and_supplemented_by_nothing(
    bare: dict[str, str],
) -> None:
    related = json.loads(bare[".zenodo.json"])["related_identifiers"]
    assert [link["identifier"] for link in related] == [PAPER["doi"]] * 2
    # Zenodo's words; DataCite's are the same with a capital.
    assert [link["relation"] for link in related] == ["reviews", "references"]
    (reference,) = yaml.safe_load(bare["CITATION.cff"])["references"]
    assert reference["doi"] == PAPER["doi"]
    assert "reviews" in reference["notes"]
    crate = entities(bare["ro-crate-metadata.json"])
    paper = f"https://doi.org/{PAPER['doi']}"
    reviews = [e for e in crate.values() if "Review" in e["@type"]]
    assert [review["itemReviewed"]["@id"] for review in reviews] == [paper]
    assert crate["./"]["citation"] == {"@id": paper}


def test_the_crate_names_what_is_there_and_every_reference_leads_somewhere(
    public: dict[str, str],
) -> None:
    crate = entities(public["ro-crate-metadata.json"])
    assert crate["ro-crate-metadata.json"]["about"] == {"@id": "./"}
    parts = [part["@id"] for part in crate["./"]["hasPart"]]
    for name in parts:
        assert (ROOT / name).is_dir() == name.endswith("/"), name
        assert (ROOT / name).exists(), name
    lone = [value for value in values(crate) if isinstance(value, dict) and set(value) == {"@id"}]
    outside = {"https://w3id.org/ro/crate/1.2"}
    assert {reference["@id"] for reference in lone} - set(crate) == outside
    people = [entity for entity in crate.values() if entity["@type"] == "Person"]
    assert len(people) == len(PAPER["authors"])


CODEMETA = {
    "name", "description", "version", "datePublished", "identifier", "license", "codeRepository",
    "issueTracker", "author", "keywords", "programmingLanguage", "runtimePlatform", "citation",
    "familyName", "givenName",
}  # fmt: skip
"""Words of CodeMeta 3.0, compared with its context once."""


def test_codemeta_uses_words_that_codemeta_has(public: dict[str, str]) -> None:
    code = json.loads(public["codemeta.json"])
    assert code["@context"] == "https://w3id.org/codemeta/3.0"
    tables = [code, *(value for value in values(code) if isinstance(value, dict))]
    words = {key for table in tables for key in table if not key.startswith("@")}
    assert words <= CODEMETA
    kinds = {table["@type"] for table in tables}
    assert kinds == {"SoftwareSourceCode", "Organization", "Person", "schema:ScholarlyArticle"}
