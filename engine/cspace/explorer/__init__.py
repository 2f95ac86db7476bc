"""A page in which a reader moves the arm and sees which poses are feasible.

``data`` makes the data of the page; ``page`` joins them with the scripts and the style in ``web``;
`explore` shows the page in a notebook or saves it.
"""

from cspace.explorer.page import Explorer, explore, explorer_page

__all__ = ["Explorer", "explore", "explorer_page"]
