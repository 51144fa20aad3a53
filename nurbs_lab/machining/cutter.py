"""Milling cutters, as bodies of revolution about the vertical axis of the spindle."""

import math
from dataclasses import dataclass

from nurbs_lab.common.checks import as_choice, as_not_negative, as_positive
from nurbs_lab.machining._kernels_contact import ROUNDING, rise

KINDS = ("ball", "flat", "bull", "cone")


@dataclass(frozen=True)
class Cutter:
    """An end mill; every length in mm.

    Below the shank a cutter is a vertical cylinder whose lower rim is rounded: by the whole radius for a ball
    nose, not at all for a flat end mill, by ``corner_radius`` for a bull nose. A cone widens from its disc or
    rounded tip to the cylinder: a V-bit, a chamfer mill, a taper ball. The *tip* of a cutter is the lowest
    point of its axis; cutter locations are positions of the tip.

    Parameters
    ----------
    kind : {"ball", "flat", "bull", "cone"}
    diameter : float
        Of the cylinder.
    corner_radius : float, optional
        Of a bull nose, less than half the diameter, or of the tip of a cone, 0 by default; the other kinds
        define it themselves.
    angle : float, optional
        Of a cone, between its sides, in degrees: 90 by default, as of a V-bit; 10 or so of a taper ball.
    tip_diameter : float, optional
        Of the flat disc at the end of a cone; 0 by default.
    length : float, optional
        From the tip to the shank, no less than its cone or rounded end is high; five diameters by default.
    shank : float, optional
        Diameter of the shank; that of the cutter by default.
    holder, reach : float, optional
        Diameter of the holder, and its distance from the tip, no less than the length; given together or not.

    Raises
    ------
    TypeError, ValueError
        If there is no such cutter (the message names what is wrong).

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> cutter = nl.Cutter("bull", diameter=8.0, corner_radius=1.0)
    >>> cutter.radius, cutter.flat_radius, cutter.length
    (4.0, 3.0, 40.0)
    """

    kind: str
    diameter: float
    corner_radius: float | None = None
    length: float | None = None
    shank: float | None = None
    holder: float | None = None
    reach: float | None = None
    angle: float | None = None
    tip_diameter: float | None = None

    def __post_init__(self):
        as_choice("kind", self.kind, KINDS)
        values = {"diameter": as_positive("diameter", self.diameter)}
        if self.kind == "cone":
            angle, tip = self.angle, self.tip_diameter
            values["angle"] = as_positive("angle", 90.0 if angle is None else angle)
            values["tip_diameter"] = as_not_negative("tip_diameter", 0.0 if tip is None else tip)
        elif self.angle is not None or self.tip_diameter is not None:
            raise ValueError(f"angle and tip_diameter belong to cones, this is a {self.kind} cutter")
        values["corner_radius"] = self._corner(**values)
        if (self.holder is None) != (self.reach is None):
            raise ValueError("holder and reach belong together: its diameter and its distance from the tip")
        if self.holder is not None:
            values |= {name: as_positive(name, getattr(self, name)) for name in ("holder", "reach")}
        for name, value in values.items():
            object.__setattr__(self, name, value)
        least, reach = float(rise.py_func(self.radius, self.shape)), self.reach or math.inf
        usual = {"length": max(min(5.0 * self.diameter, reach), least), "shank": self.diameter}
        for name, value in usual.items():
            given = getattr(self, name)
            object.__setattr__(self, name, value if given is None else as_positive(name, given))
        if self.length < least * (1.0 - ROUNDING):
            raise ValueError(f"length must be at least {least:.4g}, the height of the end, got {self.length}")
        if reach < self.length:
            raise ValueError(f"reach must be at least the length {self.length:g}, got {self.reach}")

    def _corner(self, diameter, angle=0.0, tip_diameter=0.0):
        """The corner radius, if it suits the kind."""
        given = self.corner_radius
        if self.kind in ("ball", "flat"):
            own = diameter / 2 if self.kind == "ball" else 0.0
            if given is not None and as_not_negative("corner_radius", given) != own:
                raise ValueError(f"corner_radius of a {self.kind} cutter is {own}, got {given}; leave it out")
            return own
        if self.kind == "bull":
            if given is None:
                raise ValueError("corner_radius is missing: a bull nose needs one, below half its diameter")
            corner = widest = as_positive("corner_radius", given)
        else:
            if not 1.0 <= angle <= 178.0:
                raise ValueError(f"angle must be between 1 and 178 degrees, got {angle}")
            corner = as_not_negative("corner_radius", 0.0 if given is None else given)
            widest = tip_diameter / 2 + corner * math.cos(math.radians(angle / 2))
        if widest >= diameter / 2:
            what = "twice the corner_radius" if self.kind == "bull" else "tip_diameter with its corners"
            raise ValueError(f"{what} must be less than the diameter {diameter}, got {2.0 * widest:.4g}")
        return corner

    @property
    def shape(self) -> tuple[float, float, float, float]:
        """Radius of the flat disc, of the corner, rise of the side over its width, radius of the cylinder."""
        slope = 1.0 / math.tan(math.radians(self.angle / 2)) if self.kind == "cone" else math.inf
        return self.flat_radius, self.corner_radius, slope, self.radius

    @property
    def radius(self) -> float:
        """Half the diameter."""
        return self.diameter / 2

    @property
    def bodies(self) -> list[tuple[str, float, float]]:
        """What must not touch anything: name, radius, and height of its lower end above the tip."""
        bodies = [("shank", self.shank / 2, self.length)]
        return bodies if self.holder is None else [*bodies, ("holder", self.holder / 2, self.reach)]

    @property
    def flat_radius(self) -> float:
        """Radius of the flat disc at the bottom: 0 for a ball nose."""
        return self.tip_diameter / 2 if self.kind == "cone" else self.radius - self.corner_radius
