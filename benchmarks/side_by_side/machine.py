"""What the measurements were made on: no names of hosts or persons."""

from __future__ import annotations

import os
import platform
import sys
from pathlib import Path


def machine() -> dict[str, object]:
    """Return processor, cores, memory, system and Python."""
    return {
        "processor": processor(),
        "cores": os.cpu_count(),
        "memory": memory(),
        "system": f"{platform.system()} {platform.release().split('-')[0]}",
        "architecture": platform.machine(),
        "python": platform.python_version(),
        "compiler": sys.implementation.name,
    }


def processor() -> str:
    """Return the model of the processor, as the system tells it."""
    return _told("/proc/cpuinfo", "model name") or platform.processor() or "unknown"


def memory() -> int | None:
    """Return the size of the memory, in bytes; None where the system does not tell."""
    found = _told("/proc/meminfo", "MemTotal")
    return int(found.split()[0]) * 1024 if found else None


def load() -> float | None:
    """Return how many processes were ready to run over the last minute."""
    return round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else None


def _told(file: str, name: str) -> str | None:
    if not Path(file).exists():
        return None
    for line in Path(file).read_text(encoding="utf-8").splitlines():
        if line.startswith(name):
            return line.partition(":")[2].strip()
    return None
