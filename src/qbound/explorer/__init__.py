"""A page in which one moves the arm, and sees which poses are safe and what stands between them.

``data`` is what the page is told, ``page`` puts it together with the scripts and the style in
``web``; `explore` shows it in a notebook or saves it. ``surface_page`` is another page: a surface
of three joints, to be turned by hand.
"""

from qbound.explorer.page import Explorer, explore, explorer_page

__all__ = ["Explorer", "explore", "explorer_page"]
