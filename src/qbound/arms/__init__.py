"""What of arms with more joints than a plane can show? Each module answers one question.

- contacts of links: `links` (their balls), `pair_forms` (how near two of them come), `closest`
  (where), `everywhere` (proofs over all cells), `allowed` (which never meet, which always do),
  `allowed_report` (as JSON, a table, and the SRDF of planners).
"""
