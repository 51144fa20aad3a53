"""Feedrate v(t), steppers, tool paths and their error (paper 3.1)."""

from nurbs_lab.motion.feed import FeedProfile
from nurbs_lab.motion.plan import plan_feed
from nurbs_lab.motion.steppers import STEPPERS, Job, Stepper, Steps, register
from nurbs_lab.motion.toolpath import ToolPath
from nurbs_lab.motion.trace import trace

__all__ = ["STEPPERS", "FeedProfile", "Job", "Stepper", "Steps", "ToolPath", "plan_feed", "register", "trace"]
