"""What does a number of an arm's design do to its measures? A grid of arms, each one measured.

- `specification`: the file that says which arm, which numbers, which measures, checked;
- `measures`: the names of measures, and what computes each;
- `grid`: the arms of a sweep as cells, and the chunks in which they are measured;
- `cells`: the measures of one chunk, on whatever machine;
- `store`: the folder of a sweep: chunks written once, never half; `cluster`: Dask;
- `run`: all of it, from where it was left.

It needs `qbound[cluster]`. Not in the paper.
"""

from qbound.sweeps.run import Swept, sweep

__all__ = ["Swept", "sweep"]
