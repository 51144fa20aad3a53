"""Nobody waits for the compiler: what ``nurbs_lab.warm`` compiles at set-up is all that calls need."""

import subprocess
import sys

CODE = """
import sys
from numba.core.dispatcher import Dispatcher
from nurbs_lab.warm import warm

def compiled():
    names = set()
    for module in [m for name, m in sys.modules.items() if name.startswith("nurbs_lab.")]:
        for name, kernel in vars(module).items():
            if isinstance(kernel, Dispatcher):
                label = f"{kernel.__module__}.{kernel.__name__}"
                names.update(f"{label}{types}" for types in kernel.signatures)
    return names

warm()
known = compiled()
from nurbs_lab.tests.robust.calls import BALL, nl
from nurbs_lab.tests.robust.calls_parts import ARRAYS, CALLS
from nurbs_lab.tests.robust.test_dress import locked, np, strided
for call, good in CALLS.values():
    call(**good)
for name, argument in ARRAYS:
    call, good = CALLS[name]
    for form in (locked, np.asfortranarray, strided):
        call(**{**good, argument: form(good[argument])})
nl.reconstruct(BALL, tolerance=0.5)
BALL.export(sys.argv[1])
nl.slice_mesh(sys.argv[1], [0.0, 0.5])
nl.slice_mesh(sys.argv[1], [0.0, 0.5], axis="x")
nl.trace(nl.paper.CURVE, nl.paper.SPEED, period_s=nl.paper.PERIOD_S)
print(*sorted(compiled() - known), sep="\\n")
"""


def test_no_call_compiles_what_warm_did_not(tmp_path):
    command = [sys.executable, "-c", CODE, tmp_path / "ball.stl"]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert ran.stdout == "\n"
