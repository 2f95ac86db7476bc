"""What several test files of the engine share, and of the companion and the book.

`robots`, `robot_files`, `arms`: robots at random, as objects, as texts, for the explorer.
`forms`, `exact`: forms and problems without a robot, the table of edge cases.
`regions`: what must hold of every region.
`oracles`: independent ways to the same numbers.
`browser`: pages in Chromium.
"""
