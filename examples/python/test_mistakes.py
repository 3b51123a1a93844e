"""Mistakes that a line fitted to three levels passes, with the tolerances and largest errors of scikit-fem's own tests."""

import numpy as np
import pytest
from poisson import errors, exact
from skfem import ElementQuad1, ElementQuad2, ElementTriP1, ElementTriP2, MeshQuad, MeshTri
from test_scikit_fem import LEVELS, mesh

import gronwall


def slope(levels, values):
    return np.polyfit(np.log(levels), np.log(values), 1)[0]


def fitted(order, found):
    """Two slopes within 0.1, and two errors on the finest of three levels."""
    slopes = all(abs(slope(LEVELS[:3], found[name][:3]) - order[name]) < 0.1 for name in order)
    return slopes and found["H1"][2] < 0.3 and found["L2"][2] < 0.008


def fitted_together(_, found):
    """One slope of both norms together, between 1.9 and 2.2, as scikit-fem's tests of boundary integrals."""
    both = np.hypot(found["L2"][:3], found["H1"][:3])
    return 1.9 < slope(LEVELS[:3], both) < 2.2 and found["H1"][2] < 0.08 and found["L2"][2] < 0.005


MISTAKES = {
    # The load is too large by 0.2 %: an error that no mesh takes away, behind a slope that looks better than it is.
    "load too large": (MeshTri, ElementTriP1, {"load": lambda x: 1.002 * exact(x)}, {"L2": 2, "H1": 1}, fitted),
    # The load is too small by 0.05 %.
    "load too small": (MeshQuad, ElementQuad1, {"load": lambda x: 0.9995 * exact(x)}, {"L2": 2, "H1": 1}, fitted),
    # The load of quadratic elements is interpolated in linear ones: the order in L2 is 2 and not 3.
    "load interpolated": (MeshTri, ElementTriP2, {"interpolated": ElementTriP1()}, {"L2": 3, "H1": 2}, fitted_together),
    # The error at the points of the assembly, where gradients of biquadratic elements are better by an order. The gate has
    # the order that was seen there, 3.
    "error at good points": (MeshQuad, ElementQuad2, {"quadrature": 3}, {"L2": 3, "H1": 2}, fitted),
}


def tables(kind, element, wrong):
    rows = [errors(mesh(kind, h), element(), **wrong) for h in LEVELS]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


@pytest.mark.parametrize("name", MISTAKES)
def test_caught(name):
    kind, element, wrong, order, gate = MISTAKES[name]
    seen = {**order, "H1": 3} if name == "error at good points" else order
    found = tables(kind, element, wrong)
    assert gate(seen, found), "the fitted line does not pass either"
    decisions = {norm: gronwall.fit(LEVELS, found[norm], order[norm]).decision for norm in order}
    assert set(decisions.values()) != {"pass"}, decisions
    # And the sound one passes.
    sound = tables(kind, element, {})
    assert {gronwall.fit(LEVELS, sound[norm], order[norm]).decision for norm in order} == {"pass"}
