"""Cutters, finishing and roughing programs, the virtual machine."""

from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import drop_cutter
from nurbs_lab.machining.part import Part, prepare_part
from nurbs_lab.machining.program import Move, Program

__all__ = ["Cutter", "Move", "Part", "Program", "drop_cutter", "prepare_part"]
