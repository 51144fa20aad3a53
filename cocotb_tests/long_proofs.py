"""Proofs that take minutes, and that no proof is empty: ``make proofs`` runs them, ``make test`` does not.

As a program it makes rtl/proofs.json of pytest's report: what each one took in seconds, or that it failed.
"""

import json
import sys
from xml.etree import ElementTree

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
    "load_guard": ("of_run && index == 10'd4", "of_run && index[2:0] == 3'd4"),
    "axil_slave": ("if (s_axil_rready)", "if (s_axil_rready || s_axil_arvalid)"),
    "nurbs_interpolator": ("write_at == LOAD_AT && writable &&", "write_at == LOAD_AT &&"),
    "step_dir": ("forward ? next - modulus", "forward ? -half"),
    "soft_limits": ("{WORD+1{move[WORD]}}", "{WORD+1{1'b0}}"),
    "banks": ("!busy || (load_space != 3'd5 && !closed[of_bank])", "!busy || load_space != 3'd5"),
    "axes": ("tick && enable && placed && !halted", "tick && enable && !halted"),
    "emergency_stop": ("on && !was_on && !pressed", "on && !was_on"),
    "watchdog": ("expired <= 1'b0;\n            silent  <= silent;", "silent  <= silent;"),
    "inputs": ("else if (away != 16'd0) away <= away - 16'd1;", "else away <= 16'd0;"),
    "adams": ("slope_of = ARRANGEMENT == 1 ? i : ~turn", "slope_of = ARRANGEMENT == 1 ? i : turn"),
    "runge_kutta": ("!(CACHED != 0 && stage == 2'd0)", "(CACHED == 0 && stage == 2'd0)"),
    "exact_step": ("{a_1, a_2} = {b1, b_tf}", "{a_1, a_2} = {b1, w}"),
    "horner": ("asks_for = {axis, 2'd3 - level}", "asks_for = {axis, level}"),
    "uart_rx": ("if (seen[2:1] == 2'b10)", "if (!seen[1])"),
    "uart_tx": ("missing  <= 4'd10;", "missing  <= 4'd9;"),
    "streamer": ("DRAIN: if (ready)", "DRAIN: if (valid)"),
    "uart_bridge": ("else if (anything) begin", "else if (came) begin"),
}
# More of them: those of the review from outside that passed the proofs of its day, then others.
MORE = [
    ("stepper", "computed || beyond_now || (far_now && sent)", "computed || (far_now && sent)"),
    ("stepper", "(far_now && sent);", "(far_now && sent && state == OFFER);"),
    ("slope", " || (want_b && b_overflow);", ";"),
    ("uart_bridge", "&& !busy && !again &&", "&& !busy &&"),
    ("feed_override", "resting <= zero;", "resting <= 1'b0;"),
    ("step_dir", "wait_for <= LONGER;", "wait_for <= LONG;"),
    ("step_dir", "if (drops) lost <= 1'b1;", ""),
    ("step_dir", "one = drops ? 4'sd0 :", "one ="),
    ("load_guard", "degree > 3'd5", "degree > 3'd6"),
    ("load_guard", "light || !unit_fits", "!unit_fits"),
    ("load_guard", "(begins || falls || ", "(begins || "),
    ("nurbs_interpolator", "&& !busy && permit && !halt)", "&& !busy && !halt)"),
    ("nurbs_interpolator", "&& permit && !halt)", "&& permit)"),
    ("nurbs_interpolator", "stop     = halt || (", "stop     = (halt && !busy) || ("),
    ("inputs", "(seen ~^ edges)", "edges"),
    ("inputs", "(left & watched)", "(changed & watched)"),
    (
        "adams",
        "{old_3, old_2, old_1} <= {old_2, old_1, push_k}",
        "{old_3, old_2, old_1} <= {old_1, old_2, push_k}",
    ),
    ("adams", "any_overflow | row_overflow", "row_overflow"),
    ("runge_kutta", "row_half   = stage == 2'd1 || stage == 2'd2", "row_half   = stage == 2'd1"),
    ("runge_kutta", "overflow  <= overflow | row_overflow", "overflow  <= row_overflow"),
    ("exact_step", "{a_tf, w, b_ef, b_ef}", "{a_tf, w, b_ef, w}"),
    ("exact_step", "h[WORD-1:EF-4] != {9{h[WORD-1]}}", "h[WORD-1:EF-3] != {8{h[WORD-1]}}"),
    ("exact_step", "{b_1, b_2} = {a_tf + b1, w}", "{b_1, b_2} = {a_tf + b2, w}"),
    ("exact_step", "e3 <= horner + (a_tf <<< 1)", "e3 <= horner + a_tf"),
    ("exact_step", "h_more <= a_ef >>> 3", "h_more <= a_ef >>> 2"),
    ("horner", "pending && level_q == 2'd3", "pending && level_q == 2'd2"),
    ("uart_rx", "wait_for <= HALF;", "wait_for <= WHOLE;"),
    ("uart_rx", "valid   <= seen[1];", "valid   <= 1'b1;"),
    ("uart_tx", "shifted  <= {1'b1, shifted[8:1]};", "shifted  <= {1'b0, shifted[8:1]};"),
    ("streamer", "overflow || beyond_now || (far_now && sent)", "overflow || (far_now && sent)"),
    ("streamer", "compared <= !pending && !compared;", "compared <= !compared;"),
    ("streamer", "adding    <= !is_last && !is_cut;", "adding    <= !is_last;"),
    ("banks", "held[load_index[0]] <= 1'b1;", "held[0] <= 1'b1;"),
    ("banks", "if (rst || close || limit) begin", "if (rst || close) begin"),
    ("axes", "(halted && !origin)", "1'b0"),
    ("soft_limits", "below <= here < lowest;", "below <= here <= lowest;"),
    ("soft_limits", "bound[0] ? given > highest", "bound[0] ? given >= highest"),
    ("emergency_stop", "else if (rst || off) enabled", "else if (rst) enabled"),
    ("emergency_stop", "on && !was_on && !pressed", "on && !pressed"),
    ("emergency_stop", "enabled && !stop && !rst;", "enabled && !stop;"),
    ("watchdog", "if (!expired) silence", "if (silent) silence"),
    ("feed_table", "e       <= e + f;", "e       <= f;"),
    ("kout", "square_last[2];", "square_last[1];"),
    ("inputs", "levels <= rst ? pins : levels ^ changed;", "levels <= rst ? pins : levels | changed;"),
    ("inputs", "if (!halt && (left", "if ((left"),
    ("axes", "if (rst || !enable || (halted && !origin)) placed", "if (rst || (halted && !origin)) placed"),
    ("axes", "wire        clear  = rst || origin || !placed;", "wire        clear  = rst || origin;"),
    ("banks", "held[oldest] <= 1'b0;", "held[!oldest] <= 1'b0;"),
    (
        "banks",
        "load_space == 3'd1 || load_space == 3'd2 ? load_index[9]",
        "load_space == 3'd2 ? load_index[9]",
    ),
    ("banks", "(bounds & ALL) == ALL && !leaves", "(bounds & ALL) == ALL"),
    ("banks", "8'hBF : 8'h8F", "8'h3F : 8'h0F"),
    ("soft_limits", "load_data > largest_step", "load_data >= largest_step"),
    ("soft_limits", "assign outside[i] = below || above;", "assign outside[i] = above;"),
    ("emergency_stop", "if (stop) seen <= 2'b11;", "if (stop) seen <= 2'b01;"),
    ("watchdog", "if (rst || !armed) begin", "if (rst) begin"),
    ("uart_rx", "failed  <= !seen[1];", "failed  <= 1'b0;"),
    (
        "uart_tx",
        "wait_for <= WHOLE;\n            line     <= shifted[0];",
        "wait_for <= WHOLE - 16'd1;\n            line     <= shifted[0];",
    ),
    ("uart_bridge", "again    <= known && asked_number == number;", "again    <= known;"),
    ("uart_bridge", "if (alert) alarm_owed <= 1'b0;", ""),
    (
        "step_dir",
        "dir      <= wanted;\n            wait_for <= BEFORE;",
        "dir      <= wanted;\n            wait_for <= 16'd0;",
    ),
    ("kout", "radicand <= {2*WORD{1'b0}};", ""),
    ("feed_table", "reading != 3'd0 && closed[bank]", "reading != 3'd0"),
    ("slope", "if (b_done) b_ready <= 1'b1;", "if (b_done || a_done) b_ready <= 1'b1;"),
    ("slope", "step[WORD] != step[WORD-1];", "1'b0;"),
    ("runge_kutta", "stage == 2'd3 ? s_whole : s_half", "stage == 2'd2 ? s_whole : s_half"),
    ("load_guard", "closed || count == 16'd0 || data", "closed || data"),
    ("streamer", "now_bits  <= bits;", "now_bits  <= next_bits;"),
    ("streamer", "bits      <= next_bits;", ""),
    ("streamer", "point_bits  <= 4'd0;", ""),
    ("axes", "if (clear || halted || !enable) outputs", "if (clear) outputs"),
    ("axes", "outputs <= !fresh ? 4'd0 : moved", "outputs <= moved"),
    ("axes", "bits   <= s_axis_tuser[4:1];", "bits   <= s_axis_tuser[3:0];"),
    ("nurbs_interpolator", "(permitted && !permit);", "(permitted && !permit && busy);"),
    ("streamer", "!load && !close && closed[0]", "closed[0]"),
    ("load_guard", "begins || falls ||", "falls ||"),
    ("load_guard", "&& counts && closed", "&& closed"),
]
#: The parameter sets of each proof.
SETS = {name: [*sets, *LONG.get(name, [])] for name, (_, _, sets) in PROOFS.items()}


@pytest.mark.parametrize(
    ("name", "parameters"), [(name, parameters) for name in LONG for parameters in LONG[name]], ids=str
)
def test_proof(tmp_path, name, parameters):
    assert prove(tmp_path, name, parameters) == "PASS"


@pytest.mark.parametrize(
    ("name", "right", "wrong"), [*((name, *change) for name, change in DEFECTS.items()), *MORE]
)
def test_a_seeded_defect_is_caught(tmp_path, name, right, wrong):
    """What is wrong has no proof with some set of parameters."""
    results = (prove(tmp_path, name, parameters, (right, wrong)) for parameters in SETS[name])
    assert any(result in ("FAIL", "UNKNOWN") for result in results)


@pytest.mark.parametrize("name", PROOFS)
def test_what_a_proof_speaks_of_can_happen(tmp_path, name):
    """Every ``cover`` of a proof is reached, so its assertions are not true of nothing."""
    assert any("cover (" in file.read_text() for file in (RTL / "formal").glob(f"{name}_*.v"))
    assert prove(tmp_path, name, SETS[name][0], mode="cover") == "PASS"


def main(report):
    cases = ElementTree.parse(report).iter("testcase")
    found = {case.get("name"): "failed" if len(case) else round(float(case.get("time"))) for case in cases}
    (RTL / "proofs.json").write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
