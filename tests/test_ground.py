"""The ground: locks, citation, the package, its import contract, what the repository holds."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from importlib.metadata import version
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from lizarraga2025.ledger import cite
from support.scripts import load_script

ROOT = Path(__file__).resolve().parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
LOCK = (ROOT / "requirements.lock").read_text(encoding="utf-8")
PINS = [f"tests/javascript/{name}" for name in ("package.json", "package-lock.json")]


# --- the lock and the metadata --------------------------------------------------------------------


def locked() -> dict[str, list[tuple[Requirement, int]]]:
    """Every pin of the lock, by name, with the number of its hashes."""
    pins: dict[str, list[tuple[Requirement, int]]] = {}
    for block in re.split(r"\n(?=\S)", LOCK.strip()):
        line, *hashes = block.replace("\\\n", "\n").split("\n")
        requirement = Requirement(line)
        count = sum(bool(re.fullmatch(r"\s+--hash=sha256:[0-9a-f]{64}\s*", h)) for h in hashes)
        assert count == len(hashes), f"not a hash in the block of {requirement.name}"
        pins.setdefault(canonicalize_name(requirement.name), []).append((requirement, count))
    return pins


def test_every_line_of_the_lock_is_a_pin_with_hashes() -> None:
    pins = [pin for found in locked().values() for pin in found]
    assert len(pins) > 100
    for requirement, hashes in pins:
        assert re.fullmatch(r"==[\w.+!]+", str(requirement.specifier)), requirement
        assert hashes > 0, requirement


def test_the_lock_holds_no_address() -> None:
    assert "://" not in LOCK
    assert not re.search(r"^\s*(-i|-f|-e|--index|--extra-index|--find-links|#)", LOCK, re.MULTILINE)


def test_the_lock_answers_every_name_in_pyproject() -> None:
    extras = PROJECT["optional-dependencies"]
    assert {"symbolic", "figures", "book", "test", "lint", "build"} <= set(extras)
    pins = locked()
    for text in (*PROJECT["dependencies"], *(name for names in extras.values() for name in names)):
        wanted = Requirement(text)
        found = pins[canonicalize_name(wanted.name)]
        for pin, _ in found:
            (pinned,) = pin.specifier
            assert wanted.specifier.contains(pinned.version), f"{text}: {pin}"


def test_all_pythons_compute_with_the_same_packages() -> None:
    split = [name for name, pins in locked().items() if len(pins) > 1]
    assert not {"numpy", "sympy", "scipy", "matplotlib", "shapely"} & set(split)


def test_environment_yml_uses_the_lock() -> None:
    conda = yaml.safe_load((ROOT / "environment.yml").read_text(encoding="utf-8"))
    *plain, pip = conda["dependencies"]
    assert pip == {"pip": ["-r requirements.lock"]}
    python = next(name for name in plain if name.startswith("python="))
    oldest = Requirement("x" + PROJECT["requires-python"]).specifier
    assert oldest.contains(python.removeprefix("python="))
    assert all(name.split("=")[0] in ("python", "pip") for name in plain)


def test_what_is_unreleased_is_a_development_version() -> None:
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert PROJECT["version"] == version("qbound")
    assert Version(PROJECT["version"]).is_devrelease == ("## [Unreleased]" in changes)


def test_the_citation_has_the_version_and_its_day() -> None:
    """Between releases it names no day: one is that of a release."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == PROJECT["version"]
    released = None if ".dev" in PROJECT["version"] else PYPROJECT["tool"]["qbound"]["released"]
    assert citation.get("date-released") == (released and str(released))
    assert citation["license"] == PROJECT["license"]


def test_the_paper_is_the_same_wherever_it_is_cited() -> None:
    """In BibTeX its letters are TeX's."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    [paper] = citation["references"]
    assert PROJECT["urls"]["Paper"] == f"https://doi.org/{paper['doi']}"
    bibliography = (ROOT / "book/references.bib").read_text(encoding="utf-8")
    accents = {"é": r"{\'e}", "á": r"{\'a}", "ó": r"{\'o}", "í": r"{\'i}"}
    fields = {key: paper[key] for key in ("title", "journal", "year", "volume", "doi")}
    fields |= {"number": paper["issue"], "pages": paper["start"]}
    for record in (cite.PAPER, bibliography.split("\n}\n")[0]):
        for key, value in fields.items():
            assert re.search(rf"\b{key} *= \{{{value}\}}", record), key
        for author in paper["authors"]:
            assert "".join(accents.get(c, c) for c in author["family-names"]) in record
        assert len(re.split(r"\sand\s", record.split("title")[0])) == len(paper["authors"])


# --- the package ----------------------------------------------------------------------------------


def build(kind: str, source: Path, target: Path) -> Path:
    """Build a wheel or an sdist of the tree at `source`, without a network."""
    call = f"import sys, setuptools.build_meta as b; print(b.build_{kind}(sys.argv[1]))"
    done = subprocess.run(
        [sys.executable, "-c", call, target], cwd=source, check=True, capture_output=True, text=True
    )
    return target / done.stdout.splitlines()[-1]


@pytest.fixture(scope="module")
def sdist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sdist, unpacked."""
    copy, target = (tmp_path_factory.mktemp(name) for name in ("copy", "sdist"))
    skip = shutil.ignore_patterns("__pycache__", "*.egg-info")
    for name in ("src", "results"):
        shutil.copytree(ROOT / name, copy / name, ignore=skip)
    for name in ("pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    with tarfile.open(build("sdist", copy, target)) as archive:
        archive.extractall(target, filter="data")
    return target / f"qbound-{PROJECT['version']}"


@pytest.fixture(scope="module")
def wheel(sdist: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel that is built from the sdist, unpacked as an installation would."""
    target = tmp_path_factory.mktemp("wheel")
    file = build("wheel", sdist, target)
    assert file.name == f"qbound-{PROJECT['version']}-py3-none-any.whl"
    with zipfile.ZipFile(file) as archive:
        archive.extractall(target / "site-packages")
    return target / "site-packages"


def files_below(folder: Path) -> dict[str, bytes]:
    return {
        p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*.*") if p.is_file()
    }


def of_both_packages(folder: Path) -> dict[str, bytes]:
    """The files of both packages, without what tools leave among them."""
    left = re.compile(r"__pycache__/|\.(egg|dist)-info/|\.pyc$")
    return {name: data for name, data in files_below(folder).items() if not left.search(name)}


def test_the_sdist_holds_every_file_of_both_packages_and_the_results(sdist: Path) -> None:
    assert of_both_packages(sdist / "src") == of_both_packages(ROOT / "src")
    assert files_below(sdist / "results") == files_below(ROOT / "results")
    assert not (sdist / "notebooks").exists()


def test_the_wheel_from_the_sdist_holds_every_file_of_both_packages(wheel: Path) -> None:
    """And results/ itself, so that `qbound claims` needs no repository."""
    results = files_below(ROOT / "results")
    recorded = {f"lizarraga2025/recorded_results/{name}": data for name, data in results.items()}
    sources = of_both_packages(ROOT / "src")
    assert {"qbound/py.typed", "lizarraga2025/py.typed"} <= set(sources)
    assert "lizarraga2025/ledger/statements/equations.toml" in sources
    assert recorded
    assert of_both_packages(wheel) == sources | recorded


ANSWERS = {
    "claims E-34": "E-34  eq. (34)",
    "claims E-34 --bibtex": "qbound-E-34",
    "claims E-5 --recompute": "E-5  eq. (5)",
    "results region/vertex.1": "region/vertex.1 = ",
    "robots show minervabot-v2": 'name = "MinervaBotV2"',
}


def test_the_wheel_answers_without_the_repository(wheel: Path, tmp_path: Path) -> None:
    lines = "from qbound.cli import main\nfor line in sys.argv[1:]: assert not main(line.split())"
    done = run_installed(wheel, tmp_path, lines, *ANSWERS)
    assert (done.returncode, done.stderr) == (0, "")
    assert [said for said in ANSWERS.values() if said not in done.stdout] == []


def test_the_wheel_loads_its_robots_and_all_its_modules(wheel: Path, tmp_path: Path) -> None:
    lines = """
import importlib, pkgutil
import lizarraga2025, qbound
for package in (lizarraga2025, qbound):
    assert package.__file__.startswith(sys.argv[1]), package.__file__
    for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
robots = [qbound.load_robot(name).name for name in qbound.packaged_robots()]
print(len(robots))
"""
    done = run_installed(wheel, tmp_path, lines, str(wheel))
    assert (done.returncode, done.stderr) == (0, "")
    assert int(done.stdout) == len(list((ROOT / "src/qbound/robots").glob("*.toml")))


def run_installed(
    wheel: Path, folder: Path, lines: str, *words: str
) -> subprocess.CompletedProcess[str]:
    """Run lines of Python that find the unpacked wheel before anything else."""
    return subprocess.run(
        [sys.executable, "-P", "-c", f"import sys\n{lines}", *words],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(wheel), "PYTHONUTF8": "1"},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )


WRONG_IMPORTS = [
    ("qbound.forms.harmonic", "qbound.model.robot", "algebra that knows kinematics"),
    ("qbound.model.frames", "qbound.forms.circle", "kinematics that knows algebra"),
    ("qbound.boundary.functions", "qbound.region.outline", "a call upward"),
    ("qbound.model.robot", "qbound.boundary.functions", "a call upward"),
    ("qbound.measures.scaling", "qbound.figures.pictures", "a call upward"),
    ("qbound.sampling", "qbound.forms.circle", "no fair opponent"),
    ("qbound.sampling", "qbound.region.outline", "no fair opponent"),
    ("qbound.region.paper_rule", "lizarraga2025.printed", "a library that reads the paper"),
    ("qbound.cli.region", "lizarraga2025.ledger.claims", "a library that reads the paper"),
    ("lizarraga2025.results", "lizarraga2025.ledger.claims", "a call upward"),
    ("lizarraga2025.printed", "qbound.geometry.polygon", "data that computes"),
    ("lizarraga2025.evidence.arms", "lizarraga2025.computations.tables", "a call upward"),
    ("lizarraga2025.computations.tables", "lizarraga2025.ledger.claims", "a call upward"),
    ("qbound.check", "qbound.tolerances", "a checker that does not stand alone"),
]
RIGHT_IMPORTS = [
    ("qbound.cli.region", "qbound.figures.pictures"),
    ("qbound.measures.scaling", "qbound.geometry.polygon"),
    ("qbound.region.paper_rule", "qbound.forms.circle"),
    ("qbound.sampling", "qbound.boundary.functions"),
    ("qbound.model.robotfile", "qbound.model.robot"),
    ("lizarraga2025.computations.tables", "lizarraga2025.printed"),
    ("lizarraga2025.computations.tables", "qbound.region.region"),
    ("qbound.forms.circle", "qbound.tolerances"),
]


def check_imports(folder: Path, imports: list[tuple[str, str]]) -> subprocess.CompletedProcess[str]:
    """Write both packages with these imports, and those that a contract lets pass; lint them."""
    contracts = PYPROJECT["tool"]["importlinter"]["contracts"]
    named = [line for contract in contracts for line in contract.get("ignore_imports", ())]
    let_pass = [tuple(line.split(" -> ")) for line in dict.fromkeys(named)]
    for source in (ROOT / "src").rglob("*.py"):
        empty = folder / source.relative_to(ROOT / "src")
        empty.parent.mkdir(parents=True, exist_ok=True)
        empty.touch()
    for importer, imported in [*let_pass, *imports]:
        with (folder / f"{importer.replace('.', '/')}.py").open("a") as module:
            module.write(f"import {imported}\n")
    shutil.copy(ROOT / "pyproject.toml", folder)
    command = "from importlinter.cli import lint_imports_command as c; c()"
    return subprocess.run(
        [sys.executable, "-c", command, "--no-cache"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder), "PYTHONUTF8": "1", "COLUMNS": "200"},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )


def test_the_import_contract_keeps_the_drawing(tmp_path: Path) -> None:
    done = check_imports(tmp_path, RIGHT_IMPORTS)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("half", [WRONG_IMPORTS[::2], WRONG_IMPORTS[1::2]], ids=["even", "odd"])
def test_the_import_contract_refuses(tmp_path: Path, half: list[tuple[str, str, str]]) -> None:
    """In a half no import begins where another ends: each is refused for itself."""
    assert not {row[0] for row in half} & {row[1] for row in half}
    done = check_imports(tmp_path, [(importer, imported) for importer, imported, _ in half])
    assert done.returncode == 1, done.stdout + done.stderr
    assert [row for row in half if f"{row[0]} -> {row[1]}" not in done.stdout] == []


def test_the_import_contract_refuses_a_module_without_a_place(tmp_path: Path) -> None:
    done = check_imports(tmp_path, [("qbound.attic", "qbound.forms.circle")])
    assert done.returncode == 1
    assert "attic" in done.stdout


# --- what the repository holds --------------------------------------------------------------------


def tracked() -> list[Path]:
    """Every file that is, or would be, committed."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a git checkout: nothing says which files belong to the repository")
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    paths = [ROOT / name for name in listed.split("\0") if name]
    return [path for path in paths if path.is_file()]


# Written in pieces, or this file would be found.
REGISTRIES = [".".join(parts) for parts in (
    ("pypi", "org"), ("pythonhosted", "org"), ("anaconda", "org"), ("npmjs", "org"),
    ("npmjs", "com"), ("jsdelivr", "net"), ("unpkg", "com"), ("deb", "debian", "org"),
)]  # fmt: skip


def test_no_file_names_a_registry_or_a_place_on_this_machine() -> None:
    banned = [*REGISTRIES, str(ROOT) + os.sep, str(Path.home()) + os.sep]
    found = [
        f"{path.relative_to(ROOT)}: {word}"
        for path in tracked()
        for word in banned
        if word.encode() in path.read_bytes()
    ]
    assert not found


def test_no_test_file_imports_another() -> None:
    """What two of them need is in `tests/support`: a file can be changed for its own sake."""
    files = sorted((ROOT / "tests").rglob("*.py"))
    names = {file.stem for file in files if file.stem.startswith(("test_", "conftest"))}
    assert len(names) > 40
    for file in files:
        tree = ast.parse(file.read_text(encoding="utf-8"))
        imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
        modules = {node.module or "" for node in imports if isinstance(node, ast.ImportFrom)}
        modules |= {alias.name for node in imports for alias in node.names}
        assert not names & {part for module in modules for part in module.split(".")}, file.name


def test_the_products_are_not_committed() -> None:
    made = [ROOT / name for name in load_script("run.py").MADE]
    assert not [path for path in tracked() if any(place in path.parents for place in made)]


def test_every_script_of_the_repository_is_checked() -> None:
    dodo = load_script("dodo.py")
    scripts = {p.relative_to(ROOT) for p in tracked() if p.suffix == ".js"}
    styled = {s for s in scripts for place in map(Path, dodo.SCRIPTS) if s.is_relative_to(place)}
    typed = {
        path.resolve().relative_to(ROOT)
        for name in dodo.PROGRAMS
        for pattern in json.loads((dodo.CHECKERS / f"{name}.json").read_text())["include"]
        for path in dodo.CHECKERS.glob(pattern)
        if path.suffix == ".js"
    }
    assert len(scripts) > 10
    assert styled == typed == scripts


def test_the_lock_of_the_checkers_pins_by_hash_and_holds_no_address() -> None:
    package, lock = ((ROOT / name).read_text(encoding="utf-8") for name in PINS)
    wanted = json.loads(package)["devDependencies"]
    pins = {name: pin for name, pin in json.loads(lock)["packages"].items() if name}
    assert {name: pins[f"node_modules/{name}"]["version"] for name in wanted} == wanted
    assert all(pin["integrity"].startswith("sha512-") for pin in pins.values())
    assert "://" not in lock
    assert "resolved" not in lock


def test_the_hooks_download_nothing() -> None:
    hooks = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))
    assert {repo["repo"] for repo in hooks["repos"]} == {"local"}
    languages = {hook["language"] for repo in hooks["repos"] for hook in repo["hooks"]}
    assert languages == {"system"}


@pytest.mark.skipif(os.name == "nt", reason="Windows has no bit for it")
def test_the_check_in_a_clean_clone_can_be_started() -> None:
    assert os.access(ROOT / ".ci/run", os.X_OK)
    assert "QBOUND_REQUIRE_BROWSER=1" in (ROOT / ".ci/run").read_text(encoding="utf-8")


def test_the_lines_of_the_readme_run() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    [lines] = re.findall(r"(?s)```python\n(.*?)```", text)
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", lines], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


PAGES = ("README.md", "CONTRIBUTING.md", "docs/ARCHITECTURE.md")


@pytest.mark.parametrize("page", PAGES)
def test_whatever_a_page_points_to_is_there(page: str) -> None:
    path = ROOT / page
    targets = re.findall(r"\]\(([^)#:]+)\)", path.read_text(encoding="utf-8"))
    assert targets
    assert [target for target in targets if not (path.parent / target).exists()] == []


def test_every_file_that_the_architecture_names_is_there() -> None:
    text = (ROOT / "docs/ARCHITECTURE.md").read_text(encoding="utf-8")
    named = re.findall(r"`([\w./]+/[\w.]*|\w+\.py)`", text)
    assert len(named) > 50
    folders = (ROOT, ROOT / "src/qbound")
    assert [name for name in named if not any((at / name).exists() for at in folders)] == []
