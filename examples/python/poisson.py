"""Poisson's problem on the unit cube of any dimension with scikit-fem: u = product of sin(pi x_i), u = 0 on the boundary."""

import numpy as np
from skfem import Basis, LinearForm, condense, solve
from skfem.models.poisson import laplace


def exact(x):
    return np.prod(np.sin(np.pi * x), axis=0)


def gradient(x):
    parts = [np.pi * np.cos(np.pi * x[i]) * np.prod(np.sin(np.pi * np.delete(x, i, axis=0)), axis=0) for i in range(len(x))]
    return np.stack(parts)


def errors(mesh, element, *, load=exact, interpolated=None, quadrature=8):
    """L2 norms of the error and of its gradient.

    The load may be interpolated in an element of its own; `quadrature` is the order of the rule of the error, finer than
    that of the assembly.
    """
    basis = Basis(mesh, element)
    if interpolated is None:
        values = load(np.asarray(basis.global_coordinates()))
    else:
        nodal = basis.with_element(interpolated)
        values = nodal.interpolate(load(nodal.doflocs))
    force = LinearForm(lambda v, w: len(w.x) * np.pi**2 * w.load * v).assemble(basis, load=values)
    u = solve(*condense(laplace.assemble(basis), force, D=basis.get_dofs()))
    fine = Basis(mesh, element, intorder=quadrature)
    found, x = fine.interpolate(u), np.asarray(fine.global_coordinates())
    norm = lambda square: float(np.sqrt(np.sum(square * fine.dx)))
    return {"L2": norm((found - exact(x)) ** 2), "H1": norm(np.sum((found.grad - gradient(x)) ** 2, axis=0))}
