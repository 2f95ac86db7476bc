"""What several test files share.

`robots`, `robot_files`, `arms`: robots at random, as objects, as texts, for the explorer.
`forms`, `exact`: forms and problems without a robot, the table of edge cases.
`regions`: what must hold of every region.
`oracles`: independent ways to the same numbers.
`worlds`: other worlds for the ledger (`tests/worlds` has one for each entry).
`browser`: pages in Chromium.
"""
