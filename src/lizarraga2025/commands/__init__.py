"""What does the companion add to the command? Two more, by the entry-point group qbound.commands.

`claims`: the ledger, shown, computed again, cited.  `results`: the recorded numbers.
"""
