"""The ground: locks, citation, the wheel, and what the repository must not hold."""

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

ROOT = Path(__file__).resolve().parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
LOCKS = ["requirements.lock", "requirements-paper.lock", "requirements-lowest.lock"]
LOCKS += [".ci/cffconvert.lock", "engine/benchmarks/side_by_side/requirements.lock"]
PINS = [f"tests/javascript/{name}" for name in ("package.json", "package-lock.json")]


def read(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", LOCKS)
def test_every_line_of_a_lock_is_a_pin_with_hashes_and_none_an_address(name: str) -> None:
    for block in re.split(r"\n(?=\S)", read(name).strip()):
        pin, *hashes = block.replace("\\\n", "\n").splitlines()
        assert re.match(r"[\w.-]+(\[.*\])?==[\w.+!]+( ;|\s*$)", pin), pin
        assert hashes
        assert all(re.fullmatch(r"\s+--hash=sha256:[0-9a-f]{64}\s*", line) for line in hashes), pin


def pins(name: str) -> dict[str, str]:
    return dict(re.findall(r"(?m)^([\w.-]+)==([\w.+!]+)", read(name)))


def test_the_chapters_about_the_paper_need_what_was_asked_for_and_nothing_of_the_engine() -> None:
    """In the versions of the lock; `qbound` and its extra name the same packages."""
    *_, python = yaml.safe_load(read("environment.yml"))["dependencies"]
    asked = dict(line.split("==") for line in python["pip"])
    assert asked.items() <= pins("requirements-paper.lock").items() <= pins(LOCKS[0]).items()
    names = ["jupyter", "jupytext", "sympy", "numpy", "matplotlib", "pytest", "nbmake"]
    assert sorted(asked) == sorted(names)
    needs = [*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["notebooks"]]
    assert sorted(re.match(r"\w+", need)[0] for need in needs) == sorted(names)
    engine = tomllib.loads(read("engine/pyproject.toml"))["project"]["dependencies"]
    only = {re.match(r"[\w-]+", need)[0] for need in engine} - {"qbound", *names}
    assert only == {"msgspec", "python-flint"}
    assert not only & pins("requirements-paper.lock").keys()


def test_the_lock_of_the_checkers_pins_by_hash_and_holds_no_address() -> None:
    package, lock = map(read, PINS)
    wanted = json.loads(package)["devDependencies"]
    pins = {name: pin for name, pin in json.loads(lock)["packages"].items() if name}
    assert {name: pins[f"node_modules/{name}"]["version"] for name in wanted} == wanted
    assert all(pin["integrity"].startswith("sha512-") for pin in pins.values())
    assert "://" not in lock


def test_the_citation_has_the_version_and_its_day() -> None:
    """Between releases it names no day: one is that of a release."""
    citation = yaml.safe_load(read("CITATION.cff"))
    assert citation["version"] == PROJECT["version"] == version("qbound")
    released = None if ".dev" in PROJECT["version"] else PYPROJECT["tool"]["qbound"]["released"]
    assert citation.get("date-released") == (released and str(released))


# --- the package ----------------------------------------------------------------------------------


def build(kind: str, source: Path, target: Path) -> Path:
    """Build a wheel or an sdist of the tree at `source`, without a network."""
    call = f"import sys, setuptools.build_meta as b; print(b.build_{kind}(sys.argv[1]))"
    done = subprocess.run(
        [sys.executable, "-c", call, target], cwd=source, check=True, capture_output=True, text=True
    )
    return target / done.stdout.splitlines()[-1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheels that are built from the sdists, unpacked as an installation would."""
    copy, target = (tmp_path_factory.mktemp(name) for name in ("copy", "made"))
    skip = shutil.ignore_patterns("__pycache__", "*.egg-info", "build", "tests", "benchmarks")
    for name in ("src", "engine", "results"):
        shutil.copytree(ROOT / name, copy / name, ignore=skip)
    for name in ("pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    for name, project in {"qbound": copy, "cspace": copy / "engine"}.items():
        with tarfile.open(build("sdist", project, target)) as archive:
            archive.extractall(target, filter="data")
        made = build("wheel", target / f"{name}-{PROJECT['version']}", target)
        with zipfile.ZipFile(made) as archive:
            archive.extractall(target / "site-packages")
    return target / "site-packages"


def files_below(folder: Path) -> dict[str, bytes]:
    """The files of a folder, without what tools leave among them."""
    left = re.compile(r"__pycache__/|\.(egg|dist)-info/|\.pyc$")
    found = {p.relative_to(folder).as_posix(): p for p in folder.rglob("*.*") if p.is_file()}
    return {name: p.read_bytes() for name, p in found.items() if not left.search(name)}


def test_the_wheel_holds_every_file_of_both_packages_and_the_results(wheel: Path) -> None:
    """So `lizarraga2025 claims` needs no repository."""
    results = files_below(ROOT / "results")
    recorded = {f"lizarraga2025/recorded_results/{name}": data for name, data in results.items()}
    assert recorded
    engine = files_below(ROOT / "engine" / "cspace")
    engine = {f"cspace/{name}": data for name, data in engine.items()}
    signed = {"lizarraga2025/pyproject.toml": (ROOT / "pyproject.toml").read_bytes()}
    assert files_below(wheel) == files_below(ROOT / "src") | engine | recorded | signed


# --- what the repository holds --------------------------------------------------------------------

# Written in pieces, or this file would be found.
REGISTRIES = [".".join(parts) for parts in (
    ("pypi", "org"), ("pythonhosted", "org"), ("anaconda", "org"), ("npmjs", "org"),
    ("npmjs", "com"), ("jsdelivr", "net"), ("unpkg", "com"), ("deb", "debian", "org"),
)]  # fmt: skip


def test_no_file_names_a_registry_or_a_place_on_this_machine() -> None:
    if not (ROOT / ".git").exists():
        pytest.skip("not a git checkout: nothing says which files belong to the repository")
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    banned = [*REGISTRIES, str(ROOT) + os.sep, str(Path.home()) + os.sep]
    for name in filter(None, listed.split("\0")):
        content = (ROOT / name).read_bytes() if (ROOT / name).is_file() else b""
        assert [word for word in banned if word.encode() in content] == [], name


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md", "docs/ARCHITECTURE.md"])
def test_whatever_a_page_points_to_is_there(page: str) -> None:
    targets = re.findall(r"\]\(([^)#:]+)\)", read(page))
    assert [
        target for target in targets if not (ROOT / page).parent.joinpath(target).exists()
    ] == []
