"""Our own: the compiled path on two threads."""

from __future__ import annotations

from qbound_compiled import compiled
from serve import serve
from streams import stream_tasks

if __name__ == "__main__":
    serve("qbound, compiled, two threads", {"numba": "numba"}, stream_tasks(compiled(2), None))
