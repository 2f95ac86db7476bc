"""Every mutant still fits its file and names a test; `mutants.py` runs them."""

import pytest

from engine_support.scripts import ROOT, load_script, names_of_tests

MUTANTS = load_script("tests/mutants.py").mutants()


def test_the_mutants_are_at_least_sixty_and_each_breaks_a_promise_of_its_own():
    assert len(MUTANTS) >= 60
    assert len({mutant["promise"] for mutant in MUTANTS}) == len(MUTANTS)


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant["function"])
def test_a_mutant_fits_its_file_and_names_a_test(mutant):
    text = (ROOT / mutant["file"]).read_text(encoding="utf-8")
    assert text.count(mutant["old"]) == 1
    assert mutant["new"] != mutant["old"]
    file, name = mutant["test"].partition("[")[0].rpartition("/")[2].split("::")
    assert name in names_of_tests(file)
