"""For every entry of the ledger a world in which its verdict is another; one file a kind.

``WORLDS`` names a world for each id; entries with one world share it, for it is entered once.
"""

from worlds import bounds, equations, figures, sentences, tables

PARTS = (equations, bounds, tables, figures, sentences)
WORLDS = {name: world for part in PARTS for name, world in part.WORLDS.items()}
