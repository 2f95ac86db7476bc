"""The printed data: complete, the same in a second typing, used as data only."""

import re
from pathlib import Path

import numpy as np
import pytest
import sympy
from numpy.testing import assert_allclose

from engine_support.oracles import arctan_of_quotient, equation_29, table_6
from lizarraga2025 import printed as paper

Q = (0.4, -0.9)
"""Where every printed formula has a value (q1 of row 6 included)."""


def evaluate(text: str, q: tuple[float, float] = Q, **reading: str) -> float:
    """A printed formula at the printed offsets."""
    known = {sympy.Symbol(k, real=True): v for k, v in paper.offsets_in_cm().items()}
    known |= dict(zip(sympy.symbols("q_1 q_2", real=True), q, strict=True))
    return complex(paper.expression(text, **reading).subs(known))


def test_counts_are_the_papers() -> None:
    """23 offsets, 11 components, 22 bounds in 11 rows, 6 bounds in the caption of Figure 4."""
    assert len(paper.OFFSETS) == 23 == len({o.label for o in paper.OFFSETS})
    assert [sum(o.table == t for o in paper.OFFSETS) for t in (1, 3, 4, 5)] == [4, 12, 4, 3]
    assert len(paper.EQUATION_29) == 11
    assert len(paper.TABLE_6) == 22
    assert len(paper.FIGURE_4_BOUNDS) == 6 == len(set(paper.FIGURE_4_BOUNDS))
    assert (len(paper.TABLE_1), len(paper.TABLE_2)) == (4, 6)


def test_bounds_are_two_a_component() -> None:
    expected = [f"{c[:-1]},{k}}}" for c in paper.EQUATION_29 for k in (1, 2)]
    assert list(paper.TABLE_6) == expected
    assert set(paper.FIGURE_4_BOUNDS) <= set(paper.TABLE_6)


def test_units_are_as_printed() -> None:
    """Tables 4 and 5 print mm."""
    assert {o.table for o in paper.OFFSETS if o.unit == "mm"} == {4, 5}
    assert {o.table for o in paper.OFFSETS if o.unit == "cm"} == {1, 3}


def test_millimetres_read_literally_are_a_tenth() -> None:
    cm, mm = paper.offsets_in_cm(), paper.offsets_in_cm(mm_means="mm")
    for offset in paper.OFFSETS:
        factor = 0.1 if offset.table in (4, 5) else 1.0
        assert mm[offset.label] == pytest.approx(factor * cm[offset.label])
    assert mm["z_{min,1}"] == pytest.approx(1.132)


def test_table_1_labels_the_offsets_of_table_1() -> None:
    assert [row[3] for row in paper.TABLE_1] == [o.label for o in paper.OFFSETS if o.table == 1]
    for a, b, _, label in paper.TABLE_1:
        assert label[1:] == f"_{{{a},{b}}}"


def test_table_1_names_a_joint_that_moves_nothing() -> None:
    joints = {q for text in paper.EQUATION_29.values() for q in re.findall(r"q\d", text)}
    named = {f"q{number}" for row in paper.TABLE_1 for number in re.findall(r"joint (\d)", row[2])}
    assert named - joints == {"q3"}


def test_vectors_have_two_indices_and_mark_no_observer_after_section_2() -> None:
    names = {name for text in paper.EQUATION_29.values() for name in re.findall(r"[xz]_\w+", text)}
    assert {name.count("_") for name in names} == {2}
    assert max(paper.OBSERVERS) < min(paper.THEOREM_1)
    assert len(set(paper.OBSERVERS.values())) == 2


@pytest.mark.parametrize("label", paper.EQUATION_29)
def test_equation_29_is_the_one_expanded_by_hand(label) -> None:
    for q in (Q, (2.0, 3.0), (-1.0, 0.0)):
        assert evaluate(paper.EQUATION_29[label], q) == pytest.approx(equation_29(*q)[label])


@pytest.mark.parametrize(
    ("reading", "by_hand"), [("arctan", arctan_of_quotient), ("atan2", np.arctan2)]
)
@pytest.mark.parametrize("label", paper.TABLE_6)
def test_table_6_is_the_one_expanded_by_hand(label, reading, by_hand) -> None:
    q1 = -0.5 if label[6] in "67" else 0.9
    printed = evaluate(paper.TABLE_6[label], (q1, 0.0), arctan=reading)
    expected = table_6(by_hand, q1)[label]
    if np.isnan(expected):
        assert abs(printed.imag) > 0  # the arccos has no real value there
    else:
        assert_allclose(printed, expected, atol=1e-12)


def test_only_the_bounds_with_a_negative_a_depend_on_the_reading() -> None:
    """E-34: x_{1,9} = -1.5 and z_{2,11} = -5.25 are the negative divisors."""
    differ = {
        label
        for label, text in paper.TABLE_6.items()
        if paper.expression(text, arctan="arctan") != paper.expression(text, arctan="atan2")
        and abs(evaluate(text, arctan="arctan") - evaluate(text, arctan="atan2")) > 1e-9
    }
    assert differ == {"beta_{2,1,1}", "beta_{2,1,2}", "beta_{3,3,1}", "beta_{3,3,2}"}


def test_formulas_speak_of_every_printed_offset_and_joint_and_of_nothing_else() -> None:
    used, both = (
        {s.name for text in texts for s in paper.expression(text).free_symbols}
        for texts in (
            paper.EQUATION_29.values(),
            [*paper.EQUATION_29.values(), *paper.TABLE_6.values()],
        )
    )
    assert used == both == {o.label for o in paper.OFFSETS} | {"q_1", "q_2"}


@pytest.mark.parametrize(
    ("name", "label"), [("x_1_10", "x_{1,10}"), ("z_min_1", "z_{min,1}"), ("q1", "q_1")]
)
def test_names_in_formulas_are_the_papers_labels(name, label) -> None:
    assert paper.label(name) == label


def test_the_library_names_no_entry_of_the_ledger() -> None:
    """It cites equations; ids belong to the companion (imports cannot show this)."""
    library = Path(__file__).parents[2] / "engine" / "cspace"
    texts = {path: path.read_text(encoding="utf-8") for path in library.rglob("*.py")}
    assert not [path for path, text in texts.items() if re.search(r"\b[EBTFS]-\d+", text)]
    assert len(texts) > 50
