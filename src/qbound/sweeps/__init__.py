"""Sweeps: measures of many arms that differ in some numbers of their design.

- `specification`: the file that says which arm, which numbers, which measures, checked;
- `measures`: the names of measures, and the function of each;
- `grid`: the arms of a sweep as cells, and the chunks in which they are measured;
- `cells`: the measures of one chunk, on whatever machine;
- `store`: the folder of a sweep: chunks written once, never half; `cluster`: Dask;
- `run`: a whole sweep, continued from the point where it stopped.

It needs `qbound[cluster]`. Not in the paper.
"""

from qbound.sweeps.run import Swept, sweep

__all__ = ["Swept", "sweep"]
