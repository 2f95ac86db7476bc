"""Two more commands for ``qbound``, added by the entry-point group qbound.commands.

`claims`: the ledger, shown, computed again, cited.  `results`: the recorded numbers.
"""
