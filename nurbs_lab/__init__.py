"""From a triangle mesh to NURBS, to a feed-controlled tool path, to hand-written hardware.

Names load on first use, so that ``import nurbs_lab`` costs nothing that a session does not need.
"""

from importlib import import_module

_HOME = {
    "map": "common.executor:map_items",
    "NurbsCurve": "nurbs",
    "NurbsSurface": "nurbs",
    "interpolate_curve": "nurbs",
    "approximate_curve": "nurbs",
    "interpolate_surface": "nurbs",
    "skin": "mesh",
    "mesh_from_points": "mesh",
    "slice_mesh": "mesh",
    "reconstruct": "mesh",
    "Limits": "motion",
    "plan_feed": "motion",
    "trace": "motion",
    "STEPPERS": "motion",
    "Cutter": "machining",
    "drop_cutter": "machining",
    "finish": "machining",
    "rough": "machining",
    "simulate": "machining",
    "verify": "machining",
    "export": "interchange",
    "read": "interchange",
    "Setup": "interchange",
    "smooth": "interchange",
}
_ROOMS = ("nurbs", "mesh", "motion", "machining", "hardware", "paper", "interchange", "plotting", "workbench")
#: Steppers that another room than ``motion`` registers, and that room.
LATE_STEPPERS = {"rtl": "nurbs_lab.hardware", "board": "nurbs_lab.hardware"}

__all__ = [*_HOME, *_ROOMS]
__version__ = "0.1.0"


def __getattr__(name):
    if name in _ROOMS:
        return import_module(f"nurbs_lab.{name}")
    if name in _HOME:
        module, _, other = _HOME[name].partition(":")
        value = getattr(import_module(f"nurbs_lab.{module}"), other or name)
        globals()[name] = value
        return value
    raise AttributeError(f"nurbs_lab has no {name!r}; it has {', '.join(__all__)}")


def __dir__():
    return __all__
