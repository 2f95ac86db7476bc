"""For every entry of the ledger a world in which its verdict is another; one file a kind.

``WORLDS`` names a world for each id; ``MISSING`` lists the ids that have none yet. Both are joined
here and used by ``tests/test_worlds.py``.
"""

from worlds import bounds, equations, figures, sentences, tables

PARTS = (equations, bounds, tables, figures, sentences)
WORLDS = {name: world for part in PARTS for name, world in part.WORLDS.items()}
MISSING = [name for part in PARTS for name in part.MISSING]
