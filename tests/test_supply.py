"""What zizmor, a part of `run.py lint`, does not see in workflows; and commands without network."""

import errno
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[1]
JOBS = {
    f"{path.stem}/{job}": content
    for path in (ROOT / ".github/workflows").glob("*.yml")
    for job, content in yaml.safe_load(path.read_text(encoding="utf-8"))["jobs"].items()
}
ELSEWHERE = "ci/systems"  # Windows and macOS, which have no network namespaces


def commands(job: str) -> list[str]:
    return [step["run"] for step in JOBS[job]["steps"] if "run" in step]


def test_only_what_publishes_may_write_and_it_runs_no_code_of_ours() -> None:
    writers = {job for job, content in JOBS.items() if "permissions" in content}
    assert writers == {"release/publish", "book/publish"}
    for job in writers:
        uses = " ".join(step.get("uses", "") for step in JOBS[job]["steps"])
        assert "checkout" not in uses
        assert not re.search(r"run\.py|python|pip|npm|\./", " ".join(commands(job)))


@pytest.mark.parametrize("job", sorted(JOBS))
def test_a_job_starts_empty_leaves_no_token_and_makes_the_book_without_a_network(job: str) -> None:
    """It starts empty, so that every chapter is executed there."""
    for step in JOBS[job]["steps"]:
        assert "cache" not in str(step)
        if "checkout" in step.get("uses", ""):
            assert step["with"]["persist-credentials"] is False
    makes = re.compile(r"run\.py (book|test|pdf|pack)|pytest")
    for command in commands(job) if job != ELSEWHERE else []:
        assert command.startswith(".ci/offline ") == bool(makes.search(command)), command


def test_packages_come_by_hash_but_for_the_numpy_that_is_not_released() -> None:
    found = [
        (job, command)
        for job in JOBS
        for command in commands(job)
        if " pip " in command and "--no-index" not in command
    ]
    assert [job for job, command in found if "--require-hashes" not in command] == ["weekly/numpy"]


REACH_OUT = """
import socket, sys
with socket.create_server(("127.0.0.1", 0)) as server:
    socket.create_connection(server.getsockname()).close()
    print("loopback")
try:
    socket.create_connection(("192.0.2.1", 80))  # an address that is kept for documents
except OSError as error:
    sys.exit(error.errno)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="namespaces are Linux's")
def test_without_a_network_the_machine_itself_is_all_that_is_reached() -> None:
    script = ROOT / ".ci/offline"
    if subprocess.run([script, "true"], capture_output=True, check=False).returncode != 0:
        pytest.skip("this system lets nobody here make a network namespace")
    command = [script, sys.executable, "-c", REACH_OUT]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.stdout, done.returncode) == ("loopback\n", errno.ENETUNREACH)
