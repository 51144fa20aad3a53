"""Cutters, finishing and roughing programs, the virtual machine."""

from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import drop_cutter
from nurbs_lab.machining.finish import finish
from nurbs_lab.machining.part import Part, prepare_part
from nurbs_lab.machining.program import MACHINE, Feeds, Move, Program
from nurbs_lab.machining.rough import rough
from nurbs_lab.machining.simulate import Simulation, simulate
from nurbs_lab.machining.stock import stock_around
from nurbs_lab.machining.verify import Verification, verify

__all__ = [
    "MACHINE",
    "Cutter",
    "Feeds",
    "Move",
    "Part",
    "Program",
    "Simulation",
    "Verification",
    "drop_cutter",
    "finish",
    "prepare_part",
    "rough",
    "simulate",
    "stock_around",
    "verify",
]
