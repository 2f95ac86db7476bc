"""Every job of the comparison, in the order in which they are asked."""

from __future__ import annotations

from streams_plan import JOBS as STREAMS

JOBS = [*STREAMS]
