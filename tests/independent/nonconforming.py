"""The scenes nonconforming-*.toml by scikit-fem: its triangles of Crouzeix and Raviart, its traces on both sides of edges
for the penalty of jumps, with the memory summed level by level, and the gap by an active set.

usage: nonconforming.py N STEPS [FIXTURE]    prints u_N by nodes as JSON, or compares it with FIXTURE (1e-9 of the largest)
"""

import json
import math
import sys

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve
from skfem import Basis, BilinearForm, ElementTriCR, ElementVector, FacetBasis, InteriorFacetBasis, LinearForm, MeshTri
from skfem import asm
from skfem.helpers import ddot, div, dot, sym_grad

LAME, SHEAR = 1.0, 0.8
REMEMBERED = (0.25, 0.3)
LAYER = 0.7


def kernel(lag):
    return -0.5 * math.exp(-2.0 * lag)


def mesh_of(n):
    """Squares cut from lower left to upper right."""
    number = lambda i, j: j * (n + 1) + i
    points = np.array([[i / n, j / n] for j in range(n + 1) for i in range(n + 1)]).T
    cells = []
    for j in range(n):
        for i in range(n):
            a, b, c, d = number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)
            cells += [[a, b, c], [a, c, d]]
    return MeshTri(points, np.array(cells).T)


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

    def load(self, t):
        body = LinearForm(lambda v, w: 0.4 * t * w.x[0] * v[0] - 0.2 * (1 + w.x[1]) * v[1])
        side = LinearForm(lambda v, w: 0.1 * t * v[0] + 0.05 * w.x[1] * v[1])
        return body.assemble(self.finer) + side.assemble(self.right)


def solve_on(free, matrix, load):
    u = np.zeros(matrix.shape[0])
    u[free] = spsolve(matrix[free][:, free], load[free])
    return u


def with_gap(body, matrix, load):
    """-u_y <= g at the midpoints of the bottom, after a layer of springs."""
    bottom, weights = body.bottom, body.weights
    layer = coo_matrix((LAYER * weights, (bottom, bottom)), shape=matrix.shape)
    matrix = (matrix + layer).tocsc()
    gap = 0.05 + 0.02 * body.basis.doflocs[0][bottom]
    locked = np.zeros(len(bottom), dtype=bool)
    for _ in range(100):
        u = np.zeros(len(load))
        u[bottom[locked]] = -gap[locked]
        free = np.setdiff1d(body.free, bottom[locked])
        rest = load - matrix @ u
        u[free] = spsolve(matrix[free][:, free], rest[free])
        pressure = (matrix @ u - load)[bottom]
        wanted = np.where(locked, pressure > 0.0, -u[bottom] > gap)
        if np.array_equal(wanted, locked):
            return u, locked
        locked = wanted
    sys.exit("the active set does not settle")


def solve(name, n, steps):
    body, k = Body(n), 1.0 / steps
    elastic, memory = body.stiffness(LAME, SHEAR), body.stiffness(*REMEMBERED)
    past, locked = [], None
    for level in range(steps + 1):
        t = level * k
        own = k / 2 if level > 0 else 0.0
        load = body.load(t)
        if name == "elastic":
            past.append(solve_on(body.free, elastic, load))
            continue
        matrix = elastic + own * kernel(0.0) * memory
        for j, u in enumerate(past):
            weight = k / 2 if j == 0 else k
            load -= weight * kernel(t - j * k) * (memory @ u)
        u, locked = with_gap(body, matrix, load)
        past.append(u)
    if locked is not None:
        print(f"  {np.sum(locked)} of {len(locked)} nodes are locked", file=sys.stderr)
    rows = {}
    for dof, (x, y) in enumerate(body.basis.doflocs.T):
        row = rows.setdefault((round(float(x), 12), round(float(y), 12)), [float(x), float(y), 0.0, 0.0])
        row[2 + body.component(dof)] = float(past[-1][dof])
    return [rows[place] for place in sorted(rows)]


def main():
    n, steps = int(sys.argv[1]), int(sys.argv[2])
    own = {name: solve(name, n, steps) for name in ("elastic", "contact")}
    if len(sys.argv) == 3:
        json.dump({"n": n, "steps": steps, "nodes": own}, sys.stdout)
        return
    with open(sys.argv[3]) as file:
        known = json.load(file)["nodes"]
    for name, rows in own.items():
        rows, other = np.array(rows), np.array(known[name])
        off = np.max(np.abs(rows - other)) / np.max(np.abs(rows[:, 2:]))
        print(f"  {name}: {off:.1e} of the largest off the fixture")
        if not off <= 1e-9:
            sys.exit(1)


main()
