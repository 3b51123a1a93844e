"""The scene nonconforming-box.toml by scikit-fem: its tetrahedra of Crouzeix and Raviart on Kuhn's mesh of a cube, its traces
on both sides of faces for the penalty of jumps, with the memory summed level by level, and the gap by an active set.

usage: nonconforming_space.py N STEPS [FIXTURE]    prints u_N by nodes as JSON, or compares it with FIXTURE (1e-9 of the largest)
"""

import itertools

import numpy as np
from plane import LAME, REMEMBERED, SHEAR, kernel, main, remembered, with_gap
from skfem import (
    Basis,
    BilinearForm,
    ElementTetCR,
    ElementVector,
    FacetBasis,
    InteriorFacetBasis,
    LinearForm,
    MeshTet,
    asm,
)
from skfem.helpers import ddot, div, dot, sym_grad


def mesh_of(n):
    """Cubes cut along their diagonal into the paths from corner to corner."""
    number = lambda p: p[0] + (n + 1) * (p[1] + (n + 1) * p[2])
    grid = [(i, j, k) for k in range(n + 1) for j in range(n + 1) for i in range(n + 1)]
    cells = []
    for origin in itertools.product(range(n), repeat=3):
        for path in itertools.permutations(range(3)):
            corner, cell = list(origin), [number(origin)]
            for axis in path:
                corner[axis] += 1
                cell.append(number(corner))
            cells.append(cell)
    return MeshTet(np.array(grid).T / n, np.array(cells).T)


class Body:
    def __init__(self, n):
        self.mesh = mesh_of(n)
        element = ElementVector(ElementTetCR())
        self.basis = Basis(self.mesh, element, intorder=2)
        self.finer = Basis(self.mesh, element, intorder=4)
        # On the boundary loads act on means: by the barycentre, exactly for these.
        right = self.mesh.facets_satisfying(lambda x: x[0] == 1.0)
        barycentre = (np.array([[1 / 3], [1 / 3]]), np.array([0.5]))
        self.right = FacetBasis(self.mesh, element, facets=right, quadrature=barycentre)
        self.sides = [InteriorFacetBasis(self.mesh, element, side=side, intorder=2) for side in (0, 1)]
        top = self.mesh.facets_satisfying(lambda x: x[1] == 1.0)
        self.top = FacetBasis(self.mesh, element, facets=top, intorder=2)
        _, y, _ = self.basis.doflocs
        self.free = np.flatnonzero(y < 1.0)
        bottom = self.mesh.facets_satisfying(lambda x: x[1] == 0.0)
        self.bottom = self.basis.facet_dofs[1, bottom]
        self.weights = np.full(len(bottom), 0.5 / n**2)

    def stiffness(self, lame, shear):
        body = BilinearForm(
            lambda u, v, _: 2 * shear * ddot(sym_grad(u), sym_grad(v)) + lame * div(u) * div(v)
        )
        matrix = body.assemble(self.basis)
        # By the roots of areas: w.h is that of the parallelogram.
        size = lambda w: w.h / np.sqrt(2.0)
        for i, one in enumerate(self.sides):
            for j, other in enumerate(self.sides):
                sign = 1.0 if i == j else -1.0
                jump = BilinearForm(lambda u, v, w: sign * 2 * shear * dot(u, v) / size(w))
                matrix = matrix + asm(jump, one, other)
        clamped = BilinearForm(lambda u, v, w: 2 * shear * dot(u, v) / size(w))
        return (matrix + clamped.assemble(self.top)).tocsc()

    def load(self, t):
        inside = LinearForm(
            lambda v, w: 0.4 * t * w.x[0] * v[0] - 0.2 * (1 + w.x[1]) * v[1] + 0.1 * w.x[2] * v[2]
        )
        side = LinearForm(lambda v, w: 0.1 * t * v[0] + 0.05 * w.x[1] * v[1] - 0.02 * w.x[2] * v[2])
        return inside.assemble(self.finer) + side.assemble(self.right)


def solve(_, n, steps):
    body, k = Body(n), 1.0 / steps
    elastic, memory = body.stiffness(LAME, SHEAR), body.stiffness(*REMEMBERED)
    past = []
    for level in range(steps + 1):
        t = level * k
        own = k / 2 if level > 0 else 0.0
        matrix = elastic + own * kernel(0.0) * memory
        u, locked = with_gap(body, matrix, body.load(t) - remembered(past, t, k, memory))
        past.append(u)
    if not 0 < np.sum(locked) < len(locked):
        raise SystemExit("the gap holds all nodes or none")
    facets = body.basis.facet_dofs
    return [[*map(float, body.basis.doflocs[:, own[0]]), *map(float, u[own])] for own in facets.T]


main(solve, ("box",))
