"""Where things come from: actions, packages, the network, and who may write."""

import errno
import re
import subprocess
import sys
import tomllib
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


def test_zizmor_sees_an_action_that_is_not_pinned_and_rights_that_are_too_wide(
    tmp_path: Path,
) -> None:
    """It is a part of `run.py lint`, and finds nothing in the workflows that are here."""
    zizmor = Path(sys.executable).with_name("zizmor")
    if not zizmor.exists():
        pytest.skip("there is no wheel of zizmor for this system")
    text = (FOLDER / "ci.yml").read_text(encoding="utf-8")
    text = re.sub("checkout@[0-9a-f]{40} #.*", "checkout@v7", text)
    text = text.replace("contents: read", "contents: write").replace("persist-credentials", "ref")
    (tmp_path / "ci.yml").write_text(text, encoding="utf-8")
    command = [zizmor, "--offline", "--quiet", "--format", "plain", tmp_path / "ci.yml"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    found = set(re.findall(r"(?m)^\w+\[([\w-]+)\]", done.stdout))
    assert {"unpinned-uses", "excessive-permissions", "artipacked"} <= found
    assert done.returncode != 0


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
    whole = ["lint", "book", "test"]
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
    library = load_script("dodo.py").LIBRARY
    text = (ROOT / "requirements-lowest.lock").read_text(encoding="utf-8")
    assert "://" not in text
    blocks = text.replace("\\\n", "").strip().splitlines()
    pins = {canonicalize_name(b.split("==")[0]): b.split("==")[1].split()[0] for b in blocks}
    assert all(re.search(r"--hash=sha256:[0-9a-f]{64}\b", block) for block in blocks)
    extras = PROJECT["optional-dependencies"]
    texts = [*PROJECT["dependencies"], *(text for name in library for text in extras[name])]
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


# --- security -------------------------------------------------------------------------------------


def test_a_forged_proof_counts_as_a_vulnerability() -> None:
    text = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
    assert "**A forged proof.**" in text
    assert "## Where to report" in text
