"""The scenes nonconforming-*.toml by scikit-fem: its triangles of Crouzeix and Raviart, its traces on both sides of edges
for the penalty of jumps, with the memory summed level by level, and the gap by an active set.

usage: nonconforming.py N STEPS [FIXTURE]    prints u_N by nodes as JSON, or compares it with FIXTURE (1e-9 of the largest)
"""

import sys

import numpy as np
from plane import LAME, REMEMBERED, SHEAR, by_nodes, kernel, load, main, mesh_of, remembered, solve_on, with_gap
from skfem import Basis, BilinearForm, ElementTriCR, ElementVector, FacetBasis, InteriorFacetBasis, asm
from skfem.helpers import ddot, div, dot, sym_grad


class Body:
    def __init__(self, n):
        self.mesh = mesh_of(n)
        element = ElementVector(ElementTriCR())
        self.basis = Basis(self.mesh, element, intorder=2)
        self.finer = Basis(self.mesh, element, intorder=4)
        # On the boundary loads act on means: by the midpoint, exactly for these.
        right = self.mesh.facets_satisfying(lambda x: x[0] == 1.0)
        midpoint = (np.array([[0.5]]), np.array([1.0]))
        self.right = FacetBasis(self.mesh, element, facets=right, quadrature=midpoint)
        self.sides = [InteriorFacetBasis(self.mesh, element, side=side, intorder=2) for side in (0, 1)]
        top = self.mesh.facets_satisfying(lambda x: x[1] == 1.0)
        self.top = FacetBasis(self.mesh, element, facets=top, intorder=2)
        _, y = self.basis.doflocs
        self.free = np.flatnonzero(y < 1.0)
        on_bottom = np.flatnonzero(y == 0.0)
        self.bottom = np.array([dof for dof in on_bottom if self.component(dof) == 1])
        self.weights = np.full(len(self.bottom), 1.0 / n)

    def component(self, dof):
        return np.argwhere(self.basis.facet_dofs == dof)[0][0] % 2

    def stiffness(self, lame, shear):
        body = BilinearForm(
            lambda u, v, _: 2 * shear * ddot(sym_grad(u), sym_grad(v)) + lame * div(u) * div(v)
        )
        matrix = body.assemble(self.basis)
        for i, one in enumerate(self.sides):
            for j, other in enumerate(self.sides):
                sign = 1.0 if i == j else -1.0
                jump = BilinearForm(lambda u, v, w: sign * 2 * shear * dot(u, v) / w.h)
                matrix = matrix + asm(jump, one, other)
        clamped = BilinearForm(lambda u, v, w: 2 * shear * dot(u, v) / w.h)
        return (matrix + clamped.assemble(self.top)).tocsc()


def solve(name, n, steps):
    body, k = Body(n), 1.0 / steps
    elastic, memory = body.stiffness(LAME, SHEAR), body.stiffness(*REMEMBERED)
    past, locked = [], None
    for level in range(steps + 1):
        t = level * k
        last_weight = k / 2 if level > 0 else 0.0
        force = load(body, t)
        if name == "elastic":
            past.append(solve_on(body.free, elastic, force))
            continue
        matrix = elastic + last_weight * kernel(0.0) * memory
        force -= remembered(past, t, k, memory)
        u, locked = with_gap(body, matrix, force)
        past.append(u)
    if locked is not None:
        print(f"  {np.sum(locked)} of {len(locked)} nodes are locked", file=sys.stderr)
    return by_nodes(body, past[-1])


main(solve, ("elastic", "contact"))
