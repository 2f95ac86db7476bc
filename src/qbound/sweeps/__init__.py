"""Sweeps: measures of many arms that differ in some numbers of their design.

- `specification`: the file that says which arm, which numbers, which measures, checked; the arms as
  a grid, and the chunks in which they are measured;
- `measures`: the names of measures, the function of each, and all of one chunk;
- `store`: the folder of a sweep: chunks written once, never half;
- `run`: a whole sweep on many processes (Dask), continued from the point where it stopped.

It needs `qbound[cluster]`. Not in the paper.
"""

from qbound.sweeps.run import Swept, sweep

__all__ = ["Swept", "sweep"]
