"""The public functions and methods of the hardware room, with a good example of every argument."""

import numpy as np

import nurbs_lab as nl
from nurbs_lab import hardware

CURVE = nl.paper.CURVE
FEED = nl.plan_feed(CURVE, speed=100.0, acceleration=10_000.0, period_s=2.0**-10)
FORMAT = hardware.Format(25)
LOADED = hardware.load_curve(CURVE, FORMAT)
LOADED_FEED = hardware.load_feed(FEED, 2.0**-10, 90, LOADED.point_fraction, FORMAT)
PROGRAM = hardware.build_program(CURVE, FEED, 2.0**-10, 90, format=FORMAT)
STEADY = nl.trace(CURVE, 100.0, stepper="paper", period_s=2.0**-10)
SLOW = nl.plan_feed(CURVE, speed=50.0, acceleration=5000.0, period_s=2.0**-10)
EXACT = hardware.build_exact_program(CURVE, SLOW, 2.0**-10)
COUNTED = hardware.Timing({"cached": np.array([50, 400, 400, 400, 60, 60])})

#: As `nurbs_lab.tests.robust.calls.CALLS`.
HARDWARE = {
    "Format": (hardware.Format, {"word": 25}),
    "load_curve": (hardware.load_curve, {"curve": CURVE, "format": FORMAT}),
    "LoadedCurve.to_u": (LOADED.to_u, {"u": np.array([0.25, 0.5])}),
    "LoadedCurve.from_u": (LOADED.from_u, {"u": np.array([1000, 2000])}),
    "LoadedCurve.from_points": (LOADED.from_points, {"points": np.array([[1000, 2000], [3, 4]])}),
    "LoadedCurve.writes": (LOADED.writes, {}),
    "load_feed": (
        hardware.load_feed,
        {"feed": FEED, "period_s": 2.0**-10, "periods": 90, "point_fraction": 20, "format": FORMAT},
    ),
    "LoadedFeed.writes": (LOADED_FEED.writes, {}),
    "evaluate_cu": (hardware.evaluate_cu, {"loaded": LOADED, "u": 1_000_000}),
    "cu_error_bound": (hardware.cu_error_bound, {"curve": CURVE, "loaded": LOADED}),
    "build_program": (
        hardware.build_program,
        {
            "curve": CURVE,
            "feed": FEED,
            "period_s": 2.0**-10,
            "periods": 90,
            "largest_step": 1.0,
            "axis_limits": np.array([[-9.0, 9.0], [-9.0, 9.0]]),
            "format": FORMAT,
        },
    ),
    "build_exact_program": (
        hardware.build_exact_program,
        {
            "curves": CURVE,
            "feed": SLOW,
            "period_s": 2.0**-10,
            "largest_step": 1.0,
            "axis_limits": np.array([[-9.0, 9.0], [-9.0, 9.0]]),
            "format": hardware.Format(),
        },
    ),
    "ExactProgram.batches": (EXACT.batches, {}),
    "ExactProgram.cuts": (EXACT.cuts, {}),
    "ExactProgram.from_positions": (EXACT.from_positions, {"positions": [0, 1000]}),
    "run_exact": (hardware.run_exact, {"program": EXACT, "rates": [256, 0, 256], "abort": 9}),
    "run_twin": (hardware.run_twin, {"program": PROGRAM}),
    "word_length_study": (
        hardware.word_length_study,
        {"curve": CURVE, "feed": FEED, "period_s": 2.0**-10, "words": (25, 27), "executor": None},
    ),
    "simulate_cu": (hardware.simulate_cu, {"curve": CURVE, "u": np.array([0.25, 0.5]), "format": FORMAT}),
    "watch_cu": (hardware.watch_cu, {"curve": CURVE, "u": np.array([0.25])}),
    "simulate_path": (
        hardware.simulate_path,
        {"program": PROGRAM, "arrangement": "cached", "watch": False},
    ),
    "count_cycles": (hardware.count_cycles, {"curve": CURVE, "steps": 5}),
    "estimate_s": (
        hardware.estimate_s,
        {"cached": True},
    ),
    "serial_parameters": (hardware.serial_parameters, {"path": STEADY}),
    "Timing.times_s": (COUNTED.times_s, {"arrangement": "cached"}),
    "Timing.paper_times_s": (COUNTED.paper_times_s, {"arrangement": "cached"}),
    "Timing.table": (COUNTED.table, {}),
    "trace in the Verilog": (
        nl.trace,
        {
            "curve": CURVE,
            "feed": FEED,
            "stepper": "rtl",
            "slope": "quotient",
            "format": FORMAT,
        },
    ),
}
