"""Proofs that take minutes: ``make proofs`` runs them, ``make test`` does not."""

import pytest

from cocotb_tests.test_formal import prove

# As in test_formal: the lemmas of one round, at the width that is built.
LONG = {
    "divide_round": (["divide"], 1, [{"WORD": 35}]),
    "square_root_round": (["square_root"], 1, [{"WORD": 35}]),
}
DEFECTS = {
    "divide_round": ("assign rest[i+1]    = less[WORD] ?", "assign rest[i+1]    = !less[WORD] ?"),
    "square_root_round": ("{1'b0, found[i], 2'b01}", "{1'b0, found[i], 2'b00}"),
}


@pytest.mark.parametrize("name", LONG)
def test_proof(tmp_path, name):
    assert prove(tmp_path, name, LONG[name][2][0], proofs=LONG) == "PASS"


@pytest.mark.parametrize("name", LONG)
def test_a_seeded_defect_is_caught(tmp_path, name):
    assert prove(tmp_path, name, LONG[name][2][0], DEFECTS[name], proofs=LONG) == "FAIL"


@pytest.mark.parametrize("name", LONG)
def test_what_a_proof_speaks_of_can_happen(tmp_path, name):
    assert prove(tmp_path, name, LONG[name][2][0], mode="cover", proofs=LONG) == "PASS"
