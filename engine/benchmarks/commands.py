"""How long every command takes on imported arms of seven joints, and what memory.

Run with ``python engine/benchmarks/commands.py``: the packaged Panda, 20 balls, and the same arm
covered so closely that it has six times the balls. Each command is a process of its own, on the
clock, with the peak of its memory; one that takes longer than LONGEST is stopped.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

LONGEST = 120.0  # seconds

HOME = "0 -45deg 0 -135deg 0 90deg 45deg"
AWAY = "30deg -45deg 0 -135deg 0 90deg 45deg"
SLICE = "panda_joint1=0 panda_joint3=0 panda_joint5=0 panda_joint6=90deg panda_joint7=45deg"
BOX = " ".join(
    f"panda_joint{k}={q - 1}deg:{q + 1}deg" for k, q in enumerate((0, -45, 0, -135, 0, 90, 45), 1)
)

COMMANDS = (
    f"region ARM --slice {SLICE}",
    f"workspace ARM --slice {SLICE}",
    f"contains ARM {HOME}",
    f"why ARM {HOME} {AWAY}",
    f"fibre ARM panda_joint4 {HOME}",
    "allowed ARM",
    f"certify ARM --box {BOX}",
    f"draw ARM -o arm.svg --slice {SLICE}",
    f"explore ARM -o arm.html --slice {SLICE}",
)
EXCESSES = {"Panda": "2cm", "Panda, covered closely": "0.2mm"}


def measured(words: list[str], folder: Path) -> tuple[float, float, int, str]:
    """Return seconds, peak memory in MB, exit status and the first line of a command."""
    start = time.monotonic()
    command = [sys.executable, "-m", "cspace", *words]
    with (folder / "said").open("w+b") as said:
        run = subprocess.Popen(command, cwd=folder, stdout=said, stderr=subprocess.STDOUT)
        stop = threading.Timer(LONGEST, run.kill)
        stop.start()
        _, status, used = os.wait4(run.pid, 0)
        stop.cancel()
        said.seek(0)
        first = said.readline().decode(errors="replace").strip()
    code = os.waitstatus_to_exitcode(status)
    return time.monotonic() - start, used.ru_maxrss / 1000, code, first


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for arm, excess in EXCESSES.items():
            imported = f"import panda.urdf --srdf panda.srdf --excess {excess} -o arm.toml"
            print(f"| {arm}: command | s | MB | exit | says |\n| --- | --- | --- | --- | --- |")
            for line in (imported, *COMMANDS):
                words = line.replace("ARM", "arm.toml").split()
                seconds, memory, code, first = measured(words, folder)
                ended = "stopped" if code < 0 else str(code)
                short = " ".join(words[:1] + [w for w in words if w.startswith("--")])
                print(f"| `{short}` | {seconds:.1f} | {memory:.0f} | {ended} | {first[:70]} |")
            print(flush=True)


if __name__ == "__main__":
    main()
