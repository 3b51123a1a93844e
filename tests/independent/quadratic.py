"""The scenes quadratic-*.toml by scikit-fem: its quadratic triangles, its quadrature and its geometry, with the memory
summed level by level, the projection by Newton's method at quadrature points, and the gap by an active set.

usage: quadratic.py N STEPS [FIXTURE]    prints u_N by nodes as JSON, or compares it with FIXTURE (1e-9 of the largest)
"""

import math
import sys

import numpy as np
from plane import LAME, REMEMBERED, SHEAR, by_nodes, kernel, load, main, mesh_of, remembered, solve_on, with_gap
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, FacetBasis, LinearForm
from skfem.helpers import ddot, div, sym_grad, trace

PROJECTED = 0.6


def kappa(zeta):
    return 0.02 + 0.05 * zeta


class Body:
    def __init__(self, n):
        self.mesh = mesh_of(n)
        element = ElementVector(ElementTriP2())
        # Exact for the products of linear strains, and for the loads.
        self.basis = Basis(self.mesh, element, intorder=2)
        self.finer = Basis(self.mesh, element, intorder=4)
        right = self.mesh.facets_satisfying(lambda x: x[0] == 1.0)
        self.right = FacetBasis(self.mesh, element, facets=right, intorder=4)
        x, y = self.basis.doflocs
        self.free = np.flatnonzero(y < 1.0)
        on_bottom = np.flatnonzero(y == 0.0)
        # Of the two unknowns of a node the second is the vertical one.
        self.bottom = np.array([dof for dof in on_bottom if self.component(dof) == 1])
        ends = np.isclose(np.mod(x[self.bottom] * n, 1.0) % 1.0, 0.0)
        simpson = np.where(ends, 2.0, 4.0) / (6.0 * n)
        simpson[(x[self.bottom] == 0.0) | (x[self.bottom] == 1.0)] /= 2.0
        self.weights = simpson

    def component(self, dof):
        nodal = self.basis.nodal_dofs
        where = np.argwhere(nodal == dof)
        if len(where):
            return where[0][0] % 2
        return np.argwhere(self.basis.facet_dofs == dof)[0][0] % 2

    def stiffness(self, lame, shear):
        form = BilinearForm(
            lambda u, v, _: 2 * shear * ddot(sym_grad(u), sym_grad(v)) + lame * div(u) * div(v)
        )
        return form.assemble(self.basis).tocsc()

    def strain_norm(self, u):
        e = sym_grad(self.basis.interpolate(u))
        return math.sqrt(np.sum(ddot(e, e) * self.basis.dx))

    def projected(self, u, limit):
        """Force and tangent of mu (e - P e), P onto deviators of at most `limit`."""

        def parts(w):
            e = sym_grad(w["u"])
            # Plane strain as the program has it: the deviator within the plane.
            half = 0.5 * trace(e)
            d = np.array([[e[0, 0] - half, e[0, 1]], [e[1, 0], e[1, 1] - half]])
            size = np.sqrt(ddot(d, d))
            over = size > limit
            safe = np.where(over, size, 1.0)
            return d, np.where(over, 1.0 - limit / safe, 0.0), np.where(over, limit / safe**3, 0.0)

        def force(v, w):
            d, factor, _ = parts(w)
            return PROJECTED * factor * ddot(d, sym_grad(v))

        def tangent(u, v, w):
            d, factor, bend = parts(w)
            e, f = sym_grad(u), sym_grad(v)
            deviators = ddot(e, f) - 0.5 * trace(e) * trace(f)
            return PROJECTED * (factor * deviators + bend * ddot(d, e) * ddot(d, f))

        field = self.basis.interpolate(u)
        return (
            LinearForm(force).assemble(self.basis, u=field),
            BilinearForm(tangent).assemble(self.basis, u=field).tocsc(),
        )


def with_projection(body, matrix, load, start, zeta_past, last_weight):
    """kappa is found by a fixed point, which converges since last_weight is small."""
    u, limit = start.copy(), kappa(zeta_past)
    for _ in range(200):
        for _ in range(50):
            force, tangent = body.projected(u, limit)
            step = solve_on(body.free, matrix + tangent, load - matrix @ u - force)
            u += step
            if np.max(np.abs(step)) <= 1e-15 * np.max(np.abs(u)):
                break
        before, limit = limit, kappa(zeta_past + last_weight * body.strain_norm(u))
        if abs(limit - before) <= 1e-15 * limit:
            return u
    sys.exit("kappa does not settle")


def solve(name, n, steps):
    body, k = Body(n), 1.0 / steps
    elastic, memory = body.stiffness(LAME, SHEAR), body.stiffness(*REMEMBERED)
    past, norms, locked = [], [], None
    for level in range(steps + 1):
        t = level * k
        last_weight = k / 2 if level > 0 else 0.0
        force = load(body, t)
        if name == "elastic":
            past.append(solve_on(body.free, elastic, force))
            continue
        matrix = elastic + last_weight * kernel(0.0) * memory
        force -= remembered(past, t, k, memory)
        if name == "projection":
            zeta = sum((k / 2 if j == 0 else k) * size for j, size in enumerate(norms))
            start = past[-1] if past else np.zeros(len(force))
            past.append(with_projection(body, matrix, force, start, zeta, last_weight))
            norms.append(body.strain_norm(past[-1]))
        else:
            u, locked = with_gap(body, matrix, force)
            past.append(u)
    if locked is not None:
        print(f"  {np.sum(locked)} of {len(locked)} nodes are locked", file=sys.stderr)
    return by_nodes(body, past[-1])


main(solve, ("elastic", "projection", "contact"))
