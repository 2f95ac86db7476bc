"""The paper's ledger: every statement that can be tested, and the verdict on it.

`claims` reads what each says (the files in ``statements``) and joins this with what its function in
`lizarraga2025.computations` finds, `page` shows the ledger in the book, `errata` what an erratum
would say; `cite` tells how to cite it, with the state of the repository.
"""
