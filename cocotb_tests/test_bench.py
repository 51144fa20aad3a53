"""The benches' own safety: nothing passes by not running, nothing waits for ever, a seed repeats."""

import random
import re
import subprocess
from pathlib import Path

import cocotb
import numpy as np
import pytest
from cocotb.triggers import RisingEdge, Timer

from cocotb_tests import bench, branches
from cocotb_tests.bench import SEED, WATCHDOG, simulate

HERE = Path(__file__).parent


@cocotb.test(**WATCHDOG)
async def draws(dut):
    """Leaves the numbers that its seeds gave."""
    Path("drawn").write_text(f"{random.random()} {np.random.default_rng(SEED).random(3)}")
    await Timer(1, "ns")


@cocotb.test(**WATCHDOG)
async def goes_wrong(dut):
    await Timer(1, "ns")
    assert len(dut.product) == 0


@cocotb.test(**WATCHDOG)
async def waits_for_ever(dut):
    await RisingEdge(dut.clk)  # which nobody drives


@pytest.fixture
def choose(monkeypatch):
    """Run only the cocotb tests of this file that a pattern names; each word length has its own folder."""

    def choose(pattern, word):
        monkeypatch.setenv("COCOTB_TEST_FILTER", pattern)
        return simulate("multiply", __file__, WORD=word)

    return choose


@pytest.mark.parametrize(
    ("pattern", "word"), [("no_such_test", 9), ("goes_wrong", 11), ("waits_for_ever", 13)]
)
def test_a_run_of_no_test_a_wrong_one_or_an_endless_one_fails(choose, pattern, word):
    with pytest.raises((AssertionError, SystemExit)):
        choose(pattern, word)


def test_a_seed_repeats(choose, monkeypatch):
    drawn = []
    for seed in (7, 7, 8):
        monkeypatch.setattr(bench, "SEED", seed)
        drawn.append((choose("draws", 15) / "drawn").read_text())
    assert drawn[0] == drawn[1] != drawn[2]


def test_waves_are_left_on_demand(choose, monkeypatch):
    monkeypatch.setenv("WAVES", "1")
    (waves,) = choose("draws", 17).glob("*.fst")
    assert waves.stat().st_size > 0


TINY = """module tiny (
    input wire [1:0] a, input wire clk, output reg [1:0] y
);
    localparam [1:0] FIXED = 1 ? 2'd3 : 2'd0; // chosen at elaboration
    wire [1:0] b = a[0] ? (a[1] ? 2'd1 : 2'd2) : FIXED;
    always @(posedge clk) begin
        y <= a <= 2'd1 ? b : 2'd0;
        if (a == 2'd3) y <= 2'd1;
        else case (a)
            2'd0, 2'd1: begin
                y <= 2'd2;
            end
            default: ;
        endcase
    end
endmodule
"""
DRIVES = """module drives;
    reg [1:0] a = 2'd0;
    reg clk = 1'b0;
    wire [1:0] y;
    tiny tiny_inst (.a(a), .clk(clk), .y(y));
    initial begin
        #1 clk = 1'b1;
        #1 clk = 1'b0; a = 2'd1;
        #1 clk = 1'b1;
        #1 $display("y %0d", y);
    end
endmodule
"""


def test_branches_are_counted(tmp_path):
    for name, text in (("tiny", TINY), ("drives", DRIVES)):
        (tmp_path / f"{name}.v").write_text(text)
    module = branches.Module(tmp_path / "tiny.v")
    (tmp_path / "probed.v").write_text(module.text)
    subprocess.run(["iverilog", "-g2005-sv", "-o", "run", "probed.v", "drives.v"], cwd=tmp_path, check=True)
    log = subprocess.run(["vvp", "run"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    assert "y 2" in log
    (tmp_path / "log").write_text(log)
    count, left = branches.results([tmp_path / "log"], [tmp_path / "tiny.v"])["tiny"]
    assert count == 4 * 2 + 2
    assert left == ["a[1] is 1", "a <= 2'd1 is 0", "a == 2'd3 is 1", "default: is 1"]


def test_the_stored_table_is_of_the_branches_that_there_are_and_all_are_reached():
    page = (branches.ROOT / "rtl" / "README.md").read_text()
    counted = {file.stem: (len(branches.Module(file).branches), []) for file in branches.VERILOG}
    assert branches.table(counted) in page


def test_every_module_has_a_bench():
    assert {file.stem for file in bench.VERILOG} <= {f.stem[5:] for f in HERE.glob("test_*.py")}


def test_every_wait_is_bounded():
    for file in HERE.glob("test_*.py"):
        assert set(re.findall(r"@cocotb\.test(.*)", file.read_text())) <= {"(**WATCHDOG)"}, file
