"""The orders of scikit-fem's elements: an element and two orders a line.

scikit-fem's own tests/test_convergence.py fits a line to three levels, and has a tolerance and two largest errors by hand for
each element. Here orders are those of the theory, and levels are run until they are decided.

    pip install ../../python scikit-fem
    pytest test_scikit_fem.py
"""

import numpy as np
import pytest
import skfem
from poisson import errors
from skfem import MeshHex, MeshLine, MeshQuad, MeshTet, MeshTri

ELEMENTS = [
    ("ElementLineP1", MeshLine, {"L2": 2, "H1": 1}),
    ("ElementLineP2", MeshLine, {"L2": 3, "H1": 2}),
    ("ElementTriP1", MeshTri, {"L2": 2, "H1": 1}),
    ("ElementTriP2", MeshTri, {"L2": 3, "H1": 2}),
    ("ElementTriMini", MeshTri, {"L2": 2, "H1": 1}),
    ("ElementQuad1", MeshQuad, {"L2": 2, "H1": 1}),
    ("ElementQuad2", MeshQuad, {"L2": 3, "H1": 2}),
    ("ElementQuadS2", MeshQuad, {"L2": 3, "H1": 2}),
    ("ElementTetP1", MeshTet, {"L2": 2, "H1": 1}),
    ("ElementHex1", MeshHex, {"L2": 2, "H1": 1}),
]

LEVELS = [1 / 4, 1 / 8, 1 / 16, 1 / 32]
# Steps of half an octave where a level has eight times the unknowns of the one before.
IN_SPACE = [1 / 4, 1 / 6, 1 / 8, 1 / 12, 1 / 16]


def mesh(kind, h):
    points = np.linspace(0, 1, round(1 / h) + 1)
    return kind(points) if kind is MeshLine else kind.init_tensor(*[points] * kind.elem.refdom.dim())


@pytest.mark.parametrize(("name", "kind", "order"), ELEMENTS, ids=[name for name, *_ in ELEMENTS])
def test_order(order_study, name, kind, order):
    element = getattr(skfem, name)()
    levels = IN_SPACE if kind in (MeshTet, MeshHex) else LEVELS
    order_study(lambda h: errors(mesh(kind, h), element), order, h=levels, fewest=4, budget=20)
