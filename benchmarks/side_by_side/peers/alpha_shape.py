"""Random sampling and the alpha shape of what is feasible, by the package alphashape.

As its documentation has it: `alphashape.alphashape(points, alpha)`, a shapely geometry
(https://alphashape.readthedocs.io/en/latest/readme.html, "Using a fixed alpha parameter"). To leave
alpha away, so that it is optimised, takes far longer still: a fixed one is its fastest way.
"""

from __future__ import annotations

from planar import arm
from quality import packed
from sampled import count_for, feasible, largest_gap, polygon_rings
from serve import Refused, Timed, serve, timed

MOST = 500_000
"""Configurations, at most: far fewer take over 20 s."""


def region(scene: str, accuracy: float) -> Timed:
    """Answer with the alpha shape; its alpha closes the gaps of a random sample."""
    import alphashape

    form = arm(scene)
    count = count_for(form, accuracy)
    if count > MOST:
        raise Refused(f"{count:.2g} configurations are more than {MOST:.0e}")
    gap = largest_gap(form, count)
    seconds, processor, shape = timed(
        lambda: alphashape.alphashape(feasible(form, count, gap), 1 / gap)
    )
    return seconds, processor, {"configurations": count, "rings": packed(polygon_rings(shape))}


if __name__ == "__main__":
    needs = {"alphashape": "alphashape", "shapely": "shapely", "numpy": "numpy"}
    serve("sampling + alpha shape", needs, {"region": region})
