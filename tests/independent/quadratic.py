"""The scenes quadratic-*.toml by scikit-fem: its quadratic triangles, its quadrature and its geometry, with the memory
summed level by level, the projection by Newton's method at quadrature points, and the gap by an active set.

usage: quadratic.py N STEPS [FIXTURE]    prints u_N by nodes as JSON, or compares it with FIXTURE (1e-9 of the largest)
"""

import json
import math
import sys

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshTri
from skfem.helpers import ddot, div, sym_grad, trace

LAME, SHEAR = 1.0, 0.8
REMEMBERED = (0.25, 0.3)
PROJECTED = 0.6
LAYER = 0.7


def kernel(lag):
    return -0.5 * math.exp(-2.0 * lag)


def kappa(zeta):
    return 0.02 + 0.05 * zeta


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

    def load(self, t):
        body = LinearForm(lambda v, w: 0.4 * t * w.x[0] * v[0] - 0.2 * (1 + w.x[1]) * v[1])
        side = LinearForm(lambda v, w: 0.1 * t * v[0] + 0.05 * w.x[1] * v[1])
        return body.assemble(self.finer) + side.assemble(self.right)

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


def solve_on(free, matrix, load):
    u = np.zeros(matrix.shape[0])
    u[free] = spsolve(matrix[free][:, free], load[free])
    return u


def with_projection(body, matrix, load, start, zeta_past, own):
    """kappa is found by a fixed point, which converges since own is small."""
    u, limit = start.copy(), kappa(zeta_past)
    for _ in range(200):
        for _ in range(50):
            force, tangent = body.projected(u, limit)
            step = solve_on(body.free, matrix + tangent, load - matrix @ u - force)
            u += step
            if np.max(np.abs(step)) <= 1e-15 * np.max(np.abs(u)):
                break
        before, limit = limit, kappa(zeta_past + own * body.strain_norm(u))
        if abs(limit - before) <= 1e-15 * limit:
            return u
    sys.exit("kappa does not settle")


def with_gap(body, matrix, load):
    """-u_y <= g at the nodes of the bottom, after a layer of springs with Simpson's weights."""
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
        # Pressure times weight: what the nodes are pushed down with.
        pressure = (matrix @ u - load)[bottom]
        wanted = np.where(locked, pressure > 0.0, -u[bottom] > gap)
        if np.array_equal(wanted, locked):
            return u, locked
        locked = wanted
    sys.exit("the active set does not settle")


def solve(name, n, steps):
    body, k = Body(n), 1.0 / steps
    elastic, memory = body.stiffness(LAME, SHEAR), body.stiffness(*REMEMBERED)
    past, norms, locked = [], [], None
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
        if name == "projection":
            zeta = sum((k / 2 if j == 0 else k) * size for j, size in enumerate(norms))
            start = past[-1] if past else np.zeros(len(load))
            past.append(with_projection(body, matrix, load, start, zeta, own))
            norms.append(body.strain_norm(past[-1]))
        else:
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
    own = {name: solve(name, n, steps) for name in ("elastic", "projection", "contact")}
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
