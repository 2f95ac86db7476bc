"""Jobs about the machine's limits, and about start-up, memory and size."""

from __future__ import annotations

from jobs import Job

KINDS = (("numpy sines", 1), ("sines", 1), ("sines", 2), ("read", 1), ("read", 2))
KINDS += (("both", 1), ("both", 2))

MODULES = ("nothing", "numpy", "qbound", "pinocchio", "fcl", "mujoco", "shapely", "numba")
MODULES += ("pydrake.all", "codac", "roboticstoolbox")

PACKAGES = ("qbound", "pin", "python-fcl", "mujoco", "shapely", "numba", "drake", "codac")
PACKAGES += ("roboticstoolbox-python",)


def limit(kind: str, threads: int) -> Job:
    """Return the job of one kernel; its id says what it does and on how many threads."""
    request = {"kind": kind, "threads": threads, "count": 10_000_000}
    label = f"{kind.replace(' ', '-')}-{threads}"
    return Job("limit", "machine", ("limits",), request, {"count": 1_000_000}, label)


JOBS = [
    *(limit(kind, threads) for kind, threads in KINDS),
    *(Job("import", module, ("startup",)) for module in MODULES),
    Job("command", "contains", ("startup",)),
    *(Job("size", name, ("startup",), rounds=1) for name in PACKAGES),
]
