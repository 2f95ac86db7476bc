"""What of arms with more than two joints?

- `separations`: which ranges of one joint does something block, whatever the other joints do?
"""
