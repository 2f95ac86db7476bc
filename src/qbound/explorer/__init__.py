"""A page in which one moves the arm: `page` writes it, ``web`` holds its script and style."""
