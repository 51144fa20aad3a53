"""Proofs that take minutes, and that no proof is empty: ``make proofs`` runs them, ``make test`` does not."""

import pytest

from cocotb_tests.test_formal import LONG, PROOFS, RTL, prove

# One defect each, as a tired hand might leave it.
DEFECTS = {
    "multiply": ("= high_low + low_high", "= high_low - low_high"),
    "divide": ("digits[0] ^ negative}", "negative}"),
    "square_root": ("{1'b0, found[i], 2'b01}", "{1'b0, found[i], 2'b00}"),
    "ui_out": ("8'h80", "8'h00"),
    "cuk": ("sum[WORD+8] ?", "1'b0 ?"),
    "divide_round": ("assign rest[i+1]    = less[WORD] ?", "assign rest[i+1]    = !less[WORD] ?"),
    "square_root_round": ("{1'b0, found[i], 2'b01}", "{1'b0, found[i], 2'b00}"),
    "kout": ("axis         <= square && axis != LAST_AXIS ?", "axis         <= square ?"),
    "cu": ("out_of_range <= outside_3", "out_of_range <= outside"),
    "slope": ("want_b && !a_busy;", "!a_busy;"),
    "vt": ("now     <= whole;", "now     <= half;"),
    "feed_table": ("record[6:0] == (bank ?", "record[6:0] == (!bank ?"),
    "feed_override": ("count < 3'd4", "count < 3'd6"),
    "stepper": ("DRAIN: if (ready)", "DRAIN: if (valid)"),
    "load_guard": ("index == 10'd4", "index[2:0] == 3'd4"),
    "axil_slave": ("if (s_axil_rready)", "if (s_axil_rready || s_axil_arvalid)"),
    "nurbs_interpolator": ("(write_at == LOAD_AT && writable)", "write_at == LOAD_AT"),
    "step_dir": ("forward ? next - modulus", "forward ? -half"),
    "soft_limits": ("{WORD+1{move[WORD]}}", "{WORD+1{1'b0}}"),
    "banks": ("!busy || (load_space != 3'd5 && !closed[of_bank])", "!busy || load_space != 3'd5"),
    "axes": ("tick && enable && placed && !halted", "tick && enable && !halted"),
    "emergency_stop": ("on && !pressed) enabled", "on) enabled"),
    "watchdog": ("expired <= 1'b0;\n            silent  <= silent;", "silent  <= silent;"),
    "uart_bridge": ("else if (anything) begin", "else if (came) begin"),
}
#: The first parameter set of each proof.
FIRST = {name: [*sets, *LONG.get(name, [])][0] for name, (_, _, sets) in PROOFS.items()}


@pytest.mark.parametrize(
    ("name", "parameters"), [(name, parameters) for name in LONG for parameters in LONG[name]], ids=str
)
def test_proof(tmp_path, name, parameters):
    assert prove(tmp_path, name, parameters) == "PASS"


@pytest.mark.parametrize("name", PROOFS)
def test_a_seeded_defect_is_caught(tmp_path, name):
    """What is wrong has no proof."""
    assert prove(tmp_path, name, FIRST[name], DEFECTS[name]) in ("FAIL", "UNKNOWN")


@pytest.mark.parametrize("name", PROOFS)
def test_what_a_proof_speaks_of_can_happen(tmp_path, name):
    """Every ``cover`` of a proof is reached, so its assertions are not true of nothing."""
    assert any("cover (" in file.read_text() for file in (RTL / "formal").glob(f"{name}_*.v"))
    assert prove(tmp_path, name, FIRST[name], mode="cover") == "PASS"
