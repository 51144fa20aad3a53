"""Random rational curves and surfaces, and closed fits, beside OpenCASCADE."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from OCP.GeomAPI import GeomAPI_ProjectPointOnCurve, GeomAPI_ProjectPointOnSurf
from OCP.gp import gp_Pnt, gp_Vec

from nurbs_lab.interchange._opencascade import curve_of, surface_of
from nurbs_lab.tests.nurbs.samples import random_curve, random_surface

seeds, degrees = st.integers(0, 10**6), st.integers(1, 7)


def xyz(thing):
    return [thing.X(), thing.Y(), thing.Z()]


@given(seeds, st.tuples(degrees, degrees), st.booleans())
@settings(max_examples=20, deadline=None)
def test_surfaces_agree(seed, both, rational):
    surface = random_surface(seed, both, rational)
    theirs = surface_of(surface)
    for u, v in np.random.default_rng(seed).uniform(0, 1, (6, 2)):
        point, vectors = gp_Pnt(), [gp_Vec() for _ in range(5)]
        theirs.D2(float(u), float(v), point, *vectors)
        ours = surface.derivatives(u, v, (2, 2))
        assert_allclose(ours[0, 0], xyz(point), atol=1e-12)
        for order, vector in zip([(1, 0), (0, 1), (2, 0), (0, 2), (1, 1)], vectors, strict=True):
            size = max(1.0, np.linalg.norm(xyz(vector)))
            assert_allclose(ours[order], xyz(vector), atol=1e-10 * size)


@pytest.mark.parametrize("seed", range(5))
def test_no_closest_point_is_farther_than_theirs(seed):
    points = np.random.default_rng(seed).normal(size=(20, 3)) * 2
    curve, surface = random_curve(seed, 3), random_surface(seed, (3, 2))
    on_curve, on_surface = curve.closest_point(points)[1], surface.closest_point(points)[1]
    for k, point in enumerate(points):
        for ours, found in (
            (on_curve[k], GeomAPI_ProjectPointOnCurve(gp_Pnt(*point), curve_of(curve))),
            (on_surface[k], GeomAPI_ProjectPointOnSurf(gp_Pnt(*point), surface_of(surface))),
        ):
            if found.NbPoints():
                assert ours <= found.LowerDistance() + 1e-9
