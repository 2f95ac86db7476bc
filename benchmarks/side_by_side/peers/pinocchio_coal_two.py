"""Pinocchio with coal on two threads, by its own batch."""

from __future__ import annotations

from pinocchio_coal import many
from serve import serve
from streams import stream_tasks

if __name__ == "__main__":
    needs = {"pinocchio": "pin", "coal": "coal"}
    serve("pinocchio + coal, two threads", needs, stream_tasks(many(2), None))
