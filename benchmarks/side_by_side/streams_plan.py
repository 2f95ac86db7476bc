"""Jobs of streams: many configurations at once, and one at a time."""

from __future__ import annotations

from jobs import Job

JOBS: list[Job] = []
