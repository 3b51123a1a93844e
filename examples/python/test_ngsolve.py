"""Orders of discontinuous methods with NGSolve, and mistakes that its own tests pass.

NGSolve's tests/pytest/test_convection1d_dg.py and test_hdg1d.py solve once, on one mesh, and ask for an error below a number
found by hand. Here the same methods run on three meshes or more, against the orders of the theory.

    pip install ../../python ngsolve
    pytest test_ngsolve.py
"""

import pytest
from ngsolve_forms import BUMP, advected, central, hybrid, x

import gronwall

CELLS = [10, 20, 40]
STEPS = [1 / cells for cells in CELLS]


def test_convection(order_study):
    # Degree 3 and four stages: order 4 in space and in time, which are refined together.
    order_study(lambda h: advected(round(1 / h)), 4, h=[*STEPS, 1 / 80])


def test_hybrid(order_study):
    order_study(lambda h: hybrid(round(1 / h)), {"L2": 3, "H1": 2}, h=[1 / 4, 1 / 8, 1 / 16, 1 / 32], fewest=4)


def bump_on_one_mesh(**wrong):
    """The gate of test_convection1d_dg.py: 20 cells of degree 4, 10 000 steps by Euler's method."""
    return advected(20, BUMP, **{"degree": 4, **wrong}, stages=1, step=1e-4) < 1e-2


def parabola_on_one_mesh(**wrong):
    """The gate of test_hdg1d.py: ten quadratic elements and a solution that lies in them."""
    return hybrid(10, 0.5 * x * (1 - x), **wrong)["L2"] ** 2 < 1e-15


MISTAKES = {
    # The mean of both sides in place of the upwind value: an order is lost at odd degrees.
    "central flux": (bump_on_one_mesh, {"flux": central}, advected, {"error": 4}),
    # The speed is wrong by 0.1 %: the bump arrives elsewhere.
    "wrong speed": (bump_on_one_mesh, {"speed": 1.001}, advected, {"error": 4}),
    # Degree 2 where a higher one is meant.
    "lower degree": (bump_on_one_mesh, {"degree": 2}, advected, {"error": 4}),
    # A sign that makes the form unsymmetric: a solution inside the space is found all the same.
    "wrong sign": (parabola_on_one_mesh, {"adjoint": 1.0}, hybrid, {"L2": 3, "H1": 2}),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_caught(name):
    gate, wrong, errors, order = MISTAKES[name]
    assert gate(**wrong), "one mesh tells as well"
    results = gronwall.study(order, h=STEPS)(lambda h: errors(round(1 / h), **wrong))()
    assert results.decision == "fail", str(results)
