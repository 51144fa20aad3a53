"""Feedrate v(t), steppers, tool paths and their error (paper 3.1)."""

from nurbs_lab.motion.certificate import Certificate
from nurbs_lab.motion.curves import BenchmarkCurve, benchmark_curves
from nurbs_lab.motion.feed import FeedProfile
from nurbs_lab.motion.leaderboard import Score, leaderboard
from nurbs_lab.motion.limits import Limits
from nurbs_lab.motion.override import apply_override
from nurbs_lab.motion.plan import plan_feed
from nurbs_lab.motion.program import plan_program, plan_windows
from nurbs_lab.motion.steppers.registry import (
    STEPPERS,
    Job,
    Option,
    Rule,
    Stepper,
    Steps,
    register,
    software_steppers,
)
from nurbs_lab.motion.toolpath import ToolPath
from nurbs_lab.motion.trace import trace

__all__ = [
    "STEPPERS",
    "BenchmarkCurve",
    "Certificate",
    "FeedProfile",
    "Job",
    "Limits",
    "Option",
    "Rule",
    "Score",
    "Stepper",
    "Steps",
    "ToolPath",
    "apply_override",
    "benchmark_curves",
    "leaderboard",
    "plan_feed",
    "plan_program",
    "plan_windows",
    "register",
    "software_steppers",
    "trace",
]
