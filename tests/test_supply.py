"""Where things come from: actions, packages, licences, the network, and who may write."""

import errno
import json
import re
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import distributions
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from support.scripts import load_script

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / ".github/workflows"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
WORKFLOWS = {p.stem: yaml.safe_load(p.read_text(encoding="utf-8")) for p in FOLDER.glob("*.yml")}
JOBS = {
    f"{name}/{job}": content
    for name, workflow in WORKFLOWS.items()
    for job, content in workflow["jobs"].items()
}
ELSEWHERE = "ci/systems"  # Windows and macOS, which have no network namespaces


def commands(job: str) -> list[str]:
    return [step["run"] for step in JOBS[job]["steps"] if "run" in step]


def written_by(permissions: dict[str, str]) -> set[str]:
    return {name for name, access in permissions.items() if access != "read"}


# --- workflows ------------------------------------------------------------------------------------


def test_there_are_workflows_to_look_at() -> None:
    assert {"ci/check", "ci/lowest", ELSEWHERE, "weekly/numpy", "book/build"} <= set(JOBS)
    assert {"release/build", "release/publish", "book/publish"} <= set(JOBS)


@pytest.mark.parametrize("name", sorted(WORKFLOWS))
def test_every_action_is_pinned_by_commit_and_says_its_release(name: str) -> None:
    text = (FOLDER / f"{name}.yml").read_text(encoding="utf-8")
    uses = re.findall(r"(?m)uses:\s*(.*)$", text)
    assert uses
    for use in uses:
        assert re.fullmatch(r"actions/[\w-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", use), use


def test_an_action_has_one_commit_in_all_workflows() -> None:
    texts = [path.read_text(encoding="utf-8") for path in FOLDER.glob("*.yml")]
    uses = {use for text in texts for use in re.findall(r"uses:\s*(\S+) ", text)}
    assert len({use.split("@")[0] for use in uses}) == len(uses)


@pytest.mark.parametrize("name", sorted(WORKFLOWS))
def test_a_workflow_reads_unless_a_job_asks_for_more(name: str) -> None:
    assert WORKFLOWS[name]["permissions"] == {"contents": "read"}
    assert "concurrency" in WORKFLOWS[name]


def test_only_what_publishes_may_write_and_it_runs_no_code_of_ours() -> None:
    writers = {job for job, content in JOBS.items() if "permissions" in content}
    assert writers == {"release/publish", "book/publish"}
    for job in writers:
        uses = " ".join(step.get("uses", "") for step in JOBS[job]["steps"])
        assert "checkout" not in uses
        assert not re.search(r"run\.py|python|pip|npm|\./", " ".join(commands(job)))
    release, pages = JOBS["release/publish"]["permissions"], JOBS["book/publish"]["permissions"]
    assert written_by(release) == {"contents", "id-token", "attestations"}
    assert written_by(pages) == {"pages", "id-token"}


@pytest.mark.parametrize("job", sorted(JOBS))
def test_no_checkout_leaves_its_token_behind(job: str) -> None:
    for step in JOBS[job]["steps"]:
        if "checkout" in step.get("uses", ""):
            assert step["with"]["persist-credentials"] is False


@pytest.mark.parametrize("job", sorted(JOBS))
def test_every_job_starts_empty(job: str) -> None:
    """So every chapter is executed there: what an earlier run has left is taken nowhere."""
    for step in JOBS[job]["steps"]:
        words = " ".join([step.get("uses", ""), *map(str, step.get("with", {}))])
        assert "cache" not in words


@pytest.mark.parametrize("job", sorted(JOBS))
def test_no_word_of_a_stranger_is_put_into_a_command(job: str) -> None:
    """A branch may be called `$(rm -rf .)`: names come in as variables."""
    assert not [command for command in commands(job) if "${{" in command]


@pytest.mark.parametrize("job", sorted(set(JOBS) - {ELSEWHERE}))
def test_what_is_installed_is_installed_first_and_the_rest_has_no_network(job: str) -> None:
    makes = re.compile(r"run\.py (book|test|pdf|pack)|pytest")
    for command in commands(job):
        assert command.startswith(".ci/offline ") == bool(makes.search(command)), command


def test_packages_come_by_hash_but_for_the_numpy_that_is_not_released() -> None:
    installs = {job: [c for c in commands(job) if " pip " in c] for job in JOBS}
    found = {(job, command) for job, lines in installs.items() for command in lines}
    assert {job for job, _ in found} == {"ci/lowest", "weekly/numpy", "weekly/citation"}
    assert [job for job, command in found if "--require-hashes" not in command] == ["weekly/numpy"]
    assert "schedule" in WORKFLOWS["weekly"][True]  # YAML 1.1 takes `on` for a truth


def test_the_check_runs_everything_on_every_python_and_the_release_too() -> None:
    whole = ["lint", "licences", "book", "test"]
    for job, expected in (("ci/check", whole), ("release/build", [*whole, "pack"])):
        assert re.findall(r"run\.py (\w+)", " ".join(commands(job))) == expected
    pythons = JOBS["ci/check"]["strategy"]["matrix"]["python"]
    assert pythons == ["3.11", "3.12", "3.13", "3.14"]
    prefix = "Programming Language :: Python :: 3."
    claimed = {c.split(" :: ")[-1] for c in PROJECT["classifiers"] if c.startswith(prefix)}
    assert claimed <= set(pythons)


def test_other_systems_are_tried_without_a_browser_and_not_claimed_before_they_pass() -> None:
    assert JOBS[ELSEWHERE]["strategy"]["matrix"]["system"] == ["windows-latest", "macos-latest"]
    assert "env" not in JOBS[ELSEWHERE]
    assert not [c for c in PROJECT["classifiers"] if c.endswith(("OS Independent", "Windows"))]


# --- the oldest versions --------------------------------------------------------------------------


def test_the_oldest_lock_holds_the_lower_bounds_of_the_library() -> None:
    run = load_script("run.py")
    text = run.LOWEST.read_text(encoding="utf-8")
    assert "://" not in text
    blocks = text.replace("\\\n", "").strip().splitlines()
    pins = {canonicalize_name(b.split("==")[0]): b.split("==")[1].split()[0] for b in blocks}
    assert all(re.search(r"--hash=sha256:[0-9a-f]{64}\b", block) for block in blocks)
    extras = PROJECT["optional-dependencies"]
    texts = [*PROJECT["dependencies"], *(text for name in run.LIBRARY for text in extras[name])]
    for wanted in map(Requirement, texts):
        (bound,) = [s for s in wanted.specifier if s.operator == ">="]
        assert Version(pins[canonicalize_name(wanted.name)]) == Version(bound.version), wanted


# --- the network ----------------------------------------------------------------------------------

REACH_OUT = """
import socket
with socket.create_server(("127.0.0.1", 0)) as server:
    socket.create_connection(server.getsockname()).close()
    print("loopback")
try:
    socket.create_connection(("192.0.2.1", 80))  # an address that is kept for documents
except OSError as error:
    print(error.errno)
"""


def offline(*command: str | Path) -> subprocess.CompletedProcess[str]:
    script = ROOT / ".ci/offline"
    tried = subprocess.run([script, "true"], capture_output=True, check=False)
    if tried.returncode != 0:
        pytest.skip("this system lets nobody here make a network namespace")
    return subprocess.run([script, *command], capture_output=True, text=True, check=False)


needs_linux = pytest.mark.skipif(sys.platform != "linux", reason="namespaces are Linux's")


@needs_linux
def test_without_a_network_the_machine_itself_is_all_that_is_reached() -> None:
    done = offline(sys.executable, "-c", REACH_OUT)
    assert done.stdout.split() == ["loopback", str(errno.ENETUNREACH)]


@needs_linux
def test_the_status_of_a_command_without_a_network_is_its_own() -> None:
    assert offline(sys.executable, "-c", "raise SystemExit(3)").returncode == 3


@needs_linux
def test_the_wheel_is_built_without_a_network(tmp_path: Path) -> None:
    """With the environment's own setuptools, and pip not allowed to ask an index."""
    run = load_script("run.py")
    copy = tmp_path / "copy"
    (copy / "src/qbound").mkdir(parents=True)
    for name in ("pyproject.toml", "setup.py", "README.md", "LICENSE"):
        (copy / name).write_bytes((ROOT / name).read_bytes())
    (copy / "src/qbound/__init__.py").touch()
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", *run.OFFLINE]
    done = offline(*pip, "--wheel-dir", tmp_path, copy)
    assert (done.returncode, done.stderr) == (0, "")
    assert list(tmp_path.glob("qbound-*.whl"))


# --- what a release is made of --------------------------------------------------------------------


@pytest.fixture
def packed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A release of a small copy, its wheel not built."""
    run = load_script("run.py")
    for folder in ("results", "book/_build/html"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "results/region.json").write_text("{}", encoding="utf-8")
    (tmp_path / "book/_build/html/index.html").write_text("<p>", encoding="utf-8")
    for name in ("pyproject.toml", *run.CITED):
        (tmp_path / name).write_bytes((ROOT / name).read_bytes())
    dist = tmp_path / "dist"
    for name, place in (("ROOT", tmp_path), ("BUILD", tmp_path / "book/_build"), ("DIST", dist)):
        monkeypatch.setattr(run, name, place)

    def wheel(_title: str, command: list[object], quiet: bool) -> None:
        assert command[command.index("--wheel-dir") + 1] == dist
        dist.mkdir()
        (dist / "qbound.whl").write_bytes(b"wheel")

    monkeypatch.setattr(run, "prepare", lambda: None)
    monkeypatch.setattr(run, "book_is_fresh", lambda: True)
    monkeypatch.setattr(run, "must", wheel)
    monkeypatch.setattr(run, "browsers", list)
    assert run.pack() == 0
    return dist


def test_a_release_holds_book_wheel_and_results_and_their_checksums(packed: Path) -> None:
    version = PROJECT["version"]
    zips = {f"qbound-{what}-{version}.zip" for what in ("book", "results")}
    names = {path.name for path in packed.iterdir()}
    assert names == zips | {"qbound.whl", "SHA256SUMS"}
    with zipfile.ZipFile(packed / f"qbound-results-{version}.zip") as archive:
        inside = {name for name in archive.namelist() if not name.endswith("/")}
    wanted = ("results/region.json", "LICENSE-text", "CITATION.cff")
    assert inside == {f"qbound-results-{version}/{name}" for name in wanted}
    check = ["sha256sum", "--check", "--strict", "SHA256SUMS"]
    sums = (packed / "SHA256SUMS").read_text(encoding="utf-8").splitlines()
    assert {line.split("  ")[1] for line in sums} == names - {"SHA256SUMS"}
    if sys.platform == "linux":
        assert subprocess.run(check, cwd=packed, capture_output=True, check=False).returncode == 0
        (packed / "qbound.whl").write_bytes(b"another wheel")
        assert subprocess.run(check, cwd=packed, capture_output=True, check=False).returncode == 1


# --- licences -------------------------------------------------------------------------------------


def test_every_licence_here_is_known() -> None:
    script = load_script("tools/licences.py")
    lines, wrong = script.report(script.python_packages())
    assert not wrong
    installed = {canonicalize_name(package.name) for package in distributions()}
    assert {canonicalize_name(line.split()[0]) for line in lines} == installed
    assert "numpy" in installed


@pytest.mark.parametrize(
    ("texts", "licence"),
    [
        (["MIT License"], "MIT"),
        (["BSD-3-Clause", "Zlib"], "BSD-3-Clause, Zlib"),
        (["mit license", "MIT"], "MIT"),
        (["Business Source License 1.1"], None),
        (["MIT", "SSPL-1.0"], None),
        ([], None),
    ],
)
def test_a_licence_that_nobody_has_looked_at_is_named(texts: list[str], licence: str) -> None:
    lines, wrong = load_script("tools/licences.py").report([("thing", "1.0", texts)])
    assert lines == ([f"thing 1.0: {licence}"] if licence else [])
    assert [line.split(":")[0] for line in wrong] == ([] if licence else ["thing"])


@pytest.mark.parametrize(
    ("metadata", "stated"),
    [
        ("License-Expression: MIT AND (BSD-2-Clause OR Zlib)", ["MIT", "BSD-2-Clause", "Zlib"]),
        ("License-Expression: MIT\nLicense: GPL", ["MIT"]),
        ("License: BSD\nClassifier: License :: OSI Approved :: MIT License", ["MIT License"]),
        ("License: Copyright 2023\n  and many words", ["Copyright 2023"]),
        ("Classifier: Topic :: Utilities", []),
    ],
)
def test_what_a_package_says_of_its_licence_is_read(
    metadata: str, stated: list[str], tmp_path: Path
) -> None:
    folder = tmp_path / "thing-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text(f"Name: thing\nVersion: 1.0\n{metadata}\n", encoding="utf-8")
    [package] = distributions(path=[str(tmp_path)])
    assert load_script("tools/licences.py").stated(package) == stated


def test_javascript_packages_are_listed_too(tmp_path: Path) -> None:
    for place, licence in (("plain", "MIT"), ("@scope/inner", "MIT OR Apache-2.0"), ("none", "")):
        (tmp_path / place).mkdir(parents=True)
        content = {"name": place, "version": "1", "license": licence}
        (tmp_path / place / "package.json").write_text(json.dumps(content), encoding="utf-8")
    script = load_script("tools/licences.py")
    lines, wrong = script.report(script.javascript_packages(tmp_path))
    assert lines == ["@scope/inner 1: Apache-2.0, MIT", "plain 1: MIT"]
    assert wrong == ["none: states no licence"]


def test_what_is_listed_says_why() -> None:
    listed = load_script("tools/licences.py").RULES["listed"]
    assert listed
    assert all(entry["licence"] and entry["reason"] for entry in listed.values())


# --- security -------------------------------------------------------------------------------------


def test_a_forged_proof_counts_as_a_vulnerability() -> None:
    text = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
    assert "**A forged proof.**" in text
    assert "## Where to report" in text
