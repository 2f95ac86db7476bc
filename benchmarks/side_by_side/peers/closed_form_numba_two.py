"""A closed form typed by hand, compiled by numba, on two threads."""

from __future__ import annotations

from closed_form_numba import compiled
from serve import serve
from streams import stream_tasks

if __name__ == "__main__":
    peer = "closed form typed by hand, numba, two threads"
    serve(peer, {"numba": "numba"}, stream_tasks(compiled(2), None))
