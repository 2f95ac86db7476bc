"""A closed form typed by hand, in NumPy."""

from __future__ import annotations

from serve import Missing, serve
from streams import Judge, stream_tasks
from typed import TYPED


def many(scene: str) -> Judge:
    if scene not in TYPED:
        raise Missing(f"nobody has typed a closed form of {scene}")
    return TYPED[scene]


def one(scene: str) -> Judge:
    judge = many(scene)
    return lambda q: bool(judge(q[None])[0])


if __name__ == "__main__":
    serve("closed form typed by hand, NumPy", {"numpy": "numpy"}, stream_tasks(many, one))
