"""A printed formula is shown with its terms in the order of the print."""

from __future__ import annotations

import pytest

from lizarraga2025 import printed as paper
from lizarraga2025.typeset import latex

AS_PRINTED = {  # Table 6 and eq. (29), as the journal sets them
    "beta_{1,1,2}": (
        r"\cos^{-1}\left(\frac{x_{0,6}}{\sqrt{x_{1,7}^{2} + z_{1,7}^{2}}}\right)"
        r" + \tan^{-1}\left(\frac{z_{1,7}}{x_{1,7}}\right) - 2 \pi"
    ),
    "beta_{2,3,2}": (
        r"-\pi + \tan^{-1}\left(\frac{-x_{1,9}}{z_{1,9}}\right)"
        r" - \cos^{-1}\left(\frac{z_{0,1} - z_{0,8}}{\sqrt{x_{1,9}^{2} + z_{1,9}^{2}}}\right)"
    ),
    "beta_{5,1,2}": (
        r"-q_1 - \pi - \cos^{-1}\left(\frac{x_{1,2} \cos(q_1) - x_{\min,1}"
        r" + z_{1,2} \sin(q_1)}{x_{2,3}}\right)"
    ),
    "beta_{7,3}": (
        r"z_{0,1} - z_{\min,1} - x_{2,3} \left(\cos(q_1) \sin(q_2) + \cos(q_2) \sin(q_1)"
        r"\right) + z_{1,2} \cos(q_1) - x_{1,2} \sin(q_1)"
    ),
}


@pytest.mark.parametrize("name", AS_PRINTED)
def test_terms_stand_where_the_paper_has_them(name: str) -> None:
    assert latex((paper.TABLE_6 | paper.EQUATION_29)[name]) == AS_PRINTED[name]


@pytest.mark.parametrize("name", [*paper.EQUATION_29, *paper.TABLE_6])
def test_every_printed_formula_can_be_shown(name: str) -> None:
    text = latex((paper.TABLE_6 | paper.EQUATION_29)[name])
    assert text.count(r"\left(") == text.count(r"\right)")
    assert "_1_" not in text


def test_what_is_no_formula_is_refused() -> None:
    with pytest.raises(ValueError, match="no part of a printed formula: x\\[0\\]"):
        latex("x[0]")
