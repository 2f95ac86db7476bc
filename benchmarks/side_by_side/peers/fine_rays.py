"""Ray bisection with strides of 0.005 rad: it does not step over thin obstacles."""

from __future__ import annotations

from functools import partial

from rays import region
from serve import serve

STRIDE = 0.005

if __name__ == "__main__":
    tasks = {"region": partial(region, stride=STRIDE)}
    serve("ray bisection, strides of 0.005", {"numpy": "numpy"}, tasks)
