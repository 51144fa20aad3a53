"""The frame of the house: packages, import directions, style, the front page, what `make help` promises."""

import ast
import os
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

import nurbs_lab as nl

ROOT = Path(nl.__file__).parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


def run(*command):
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    env = {**os.environ, "PATH": path}
    return subprocess.run(command, cwd=ROOT, env=env, capture_output=True, text=True, timeout=900)


def requirement(line):
    """('pyvista', '>=0.48') from 'pyvista[jupyter]>=0.48'."""
    name, version = re.fullmatch(r"([\w.-]+)(?:\[[\w,]+\])?\s*(.*)", line).groups()
    return name, version


def test_conda_and_pip_ask_for_the_same_packages():
    conda = {}
    for line in (ROOT / "environment.yml").read_text().splitlines():
        if match := re.match(r"  - ([\w-]+)([<>=][^\s]*)?\s+# \S", line):
            conda[match[1]] = match[2] or ""
    only_conda = {"python", "pip", "iverilog", "make"}
    asked = dict(requirement(line) for line in PYPROJECT["project"]["dependencies"])
    assert conda["python"] == PYPROJECT["project"]["requires-python"]
    assert {name: version for name, version in conda.items() if name not in only_conda} == asked


def test_every_package_is_pinned():
    pinned = dict(
        line.split("==")
        for line in (ROOT / "constraints.txt").read_text().splitlines()
        if not line.startswith("#")
    )
    extras = PYPROJECT["project"]["optional-dependencies"].values()
    for line in [*PYPROJECT["project"]["dependencies"], *(line for extra in extras for line in extra)]:
        assert requirement(line)[0] in pinned


def test_the_wheel_holds_the_package_and_no_tests(tmp_path):
    built = run(sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path))
    assert built.returncode == 0, built.stderr
    names = zipfile.ZipFile(next(tmp_path.glob("*.whl"))).namelist()
    assert {"nurbs_lab/__init__.py", "nurbs_lab/rtl/cu.v"} <= set(names)
    assert [name for name in names if "tests" in name] == []


def test_imports_point_one_way():
    result = run("lint-imports")
    assert result.returncode == 0, result.stdout


@pytest.mark.parametrize("room", ["mesh", "motion", "machining"])
def test_the_tables_of_a_room_name_its_constants_and_none_that_is_gone(room):
    files = sorted((ROOT / "nurbs_lab" / room).rglob("*.py"))
    modules = {file: ast.parse(file.read_text()) for file in files}
    constant = re.compile(r"(?<!\w)_?[A-Z][A-Z0-9_]*(?!\w)")
    told = " ".join(ast.get_docstring(modules[file]) or "" for file in files if file.name == "__init__.py")
    named, there = set(constant.findall(told)), set()
    for line in (line for module in modules.values() for line in module.body):
        if isinstance(line, ast.Assign | ast.AnnAssign):
            stored = [node for node in ast.walk(line) if isinstance(getattr(node, "ctx", None), ast.Store)]
            there |= {name for node in stored if constant.fullmatch(name := getattr(node, "id", ""))}
    assert there - named == set()
    assert {name for name in named if "_" in name} - there == set()


def test_style():
    for arguments in (("check",), ("format", "--check")):
        result = run("ruff", *arguments, ".")
        assert result.returncode == 0, result.stdout


@pytest.mark.parametrize("room", ["nurbs", "mesh", "motion", "machining", "hardware"])
def test_rooms_of_mathematics_do_not_draw(room):
    drawing = re.compile(r"\bPlotter\(|\.plot\(|pyvista\.plotting|matplotlib")
    for file in (ROOT / "nurbs_lab" / room).rglob("*.py"):
        assert not drawing.search(file.read_text()), file.name


@pytest.mark.parametrize(
    ("name", "heavy"),
    [
        ("nurbs_lab", {"numba", "pyvista", "scipy", "matplotlib", "trimesh"}),
        ("nurbs_lab.hardware", {"pyvista", "scipy.interpolate", "scipy.optimize", "matplotlib", "trimesh"}),
    ],
)
def test_import_is_light(name, heavy):
    code = f"import sys, {name}; print({heavy} & set(sys.modules))"
    assert run(sys.executable, "-c", code).stdout.strip() == "set()"


def test_no_machine_paths_or_registry_addresses():
    tracked = run("git", "ls-files").stdout.split()
    paths = re.compile(r"/(?:work|root|home|farm)/|https?://[\w.]*(?:py" + r"pi|python" + r"hosted)")
    texts = [ROOT / name for name in tracked if not name.endswith((".png", ".ipynb"))]
    assert [file.name for file in texts if file.is_file() and paths.search(file.read_text())] == []
