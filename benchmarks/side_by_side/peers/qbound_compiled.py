"""Our own: configurations judged by the compiled path, the optional one that numba compiles."""

from __future__ import annotations

from collections.abc import Callable

import scenes
from serve import serve
from streams import Judge, stream_tasks


def compiled(threads: int) -> Callable[[str], Judge]:
    """Return the maker of what judges configurations on so many threads."""

    def make(scene: str) -> Judge:
        from qbound.boundary.compiled import compiled_feasible

        return compiled_feasible(scenes.robot(scene), threads=threads)

    return make


if __name__ == "__main__":
    serve("qbound, compiled", {"numba": "numba"}, stream_tasks(compiled(1), compiled(1)))
