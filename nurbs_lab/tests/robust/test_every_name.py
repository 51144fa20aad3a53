"""No public name escapes: each is called with bad arguments by `test_inputs`, or says here why not."""

import inspect
from importlib import import_module

import pytest

from nurbs_lab.tests.robust.calls_hardware import HARDWARE
from nurbs_lab.tests.robust.calls_parts import CALLS
from nurbs_lab.tests.robust.calls_pictures import PICTURES, TIMED

RESULT = "a record that functions give back; nobody makes one by hand"
FILES = "takes files: see test_faults and interchange/test_refusals"
AUTHORS = "for authors of steppers, whose code runs as it is"

#: Name -> why no call with bad arguments is needed.
EXCLUDED = {
    **dict.fromkeys(
        ["Fit", "Contour", "Deviation", "Layer", "MeshGraph", "MeshReport", "Reconstruction", "Shell"], RESULT
    ),
    **dict.fromkeys(["BenchmarkCurve", "Job", "Score", "Steps", "ToolPath"], RESULT),
    **dict.fromkeys(["Part", "Simulation", "Verification"], RESULT),
    **dict.fromkeys(["Accuracy", "CuRun", "LoadedCurve", "LoadedFeed", "PathRun"], RESULT),
    **dict.fromkeys(["ExactProgram", "Processor", "Program", "Run", "Timing"], RESULT),
    **dict.fromkeys(["export", "read"], FILES),
    **dict.fromkeys(["Option", "Rule", "Stepper", "Option.check", "Stepper.checked", "register"], AUTHORS),
    "Format.fits": "in the innermost loop of the twins",
}
#: Arguments that are canvases of other libraries: one function refuses wrong ones for all.
CANVASES = {"ax", "stage"}
ROOMS = {
    "nurbs": CALLS,
    "mesh": CALLS,
    "motion": CALLS | TIMED,
    "machining": CALLS,
    "interchange": CALLS,
    "hardware": HARDWARE | TIMED,
    "plotting": PICTURES,
}


def public(room):
    """Functions, classes and methods of a room that take arguments: name -> names of the arguments."""
    module = import_module(f"nurbs_lab.{room}")
    for name in module.__all__:
        value = getattr(module, name)
        if not callable(value):
            continue
        yield name, arguments(value)
        for method, function in vars(value).items() if inspect.isclass(value) else ():
            if method == "__call__" or (not method.startswith("_") and not isinstance(function, property)):
                function = getattr(function, "__func__", function)
                if inspect.isfunction(function):
                    yield f"{name}.{method}", arguments(function)


def arguments(function):
    parameters = inspect.signature(function).parameters.values()
    return {p.name for p in parameters if p.kind is not p.VAR_KEYWORD} - {"self", "cls"}


@pytest.mark.parametrize("room", ROOMS)
def test_every_argument_of_every_public_name_is_tried(room):
    known = ROOMS[room]
    for name, wanted in public(room):
        if name in EXCLUDED:
            continue
        tried = {argument for call in known if call.split(" ")[0] == name for argument in known[call][1]}
        assert wanted - CANVASES <= tried, f"{room}.{name}: no bad {wanted - CANVASES - tried} is tried"


def test_nothing_is_excluded_that_is_no_longer_there():
    names = {name for room in ROOMS for name, _ in public(room)}
    assert set(EXCLUDED) <= names
