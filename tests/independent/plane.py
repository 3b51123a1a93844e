"""What the programs by scikit-fem share that stand beside the solver on the unit square: the mesh, the loads, the gap by an
active set, and the comparison with a fixture."""

import json
import math
import sys

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve
from skfem import LinearForm, MeshTri

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


def load(body, t):
    """Of the body force by `body.finer`, of the traction by `body.right`."""
    inside = LinearForm(lambda v, w: 0.4 * t * w.x[0] * v[0] - 0.2 * (1 + w.x[1]) * v[1])
    side = LinearForm(lambda v, w: 0.1 * t * v[0] + 0.05 * w.x[1] * v[1])
    return inside.assemble(body.finer) + side.assemble(body.right)


def remembered(past, t, k, memory):
    """The memory of earlier levels by the trapezoidal rule, as a force."""
    force = np.zeros(memory.shape[0])
    for j, u in enumerate(past):
        weight = k / 2 if j == 0 else k
        force += weight * kernel(t - j * k) * (memory @ u)
    return force


def solve_on(free, matrix, load):
    u = np.zeros(matrix.shape[0])
    u[free] = spsolve(matrix[free][:, free], load[free])
    return u


def with_gap(body, matrix, load):
    """-u_y <= g at the nodes of the bottom, after a layer of springs with the weights of the body."""
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


def by_nodes(body, u):
    """[x, y, u_x, u_y] of all nodes."""
    rows = {}
    for dof, (x, y) in enumerate(body.basis.doflocs.T):
        row = rows.setdefault((round(float(x), 12), round(float(y), 12)), [float(x), float(y), 0.0, 0.0])
        row[2 + body.component(dof)] = float(u[dof])
    return [rows[place] for place in sorted(rows)]


def main(solve, names):
    n, steps = int(sys.argv[1]), int(sys.argv[2])
    found = {name: solve(name, n, steps) for name in names}
    if len(sys.argv) == 3:
        json.dump({"n": n, "steps": steps, "nodes": found}, sys.stdout)
        return
    with open(sys.argv[3]) as file:
        known = json.load(file)["nodes"]
    for name, rows in found.items():
        rows, other = np.array(rows), np.array(known[name])
        off = np.max(np.abs(rows - other)) / np.max(np.abs(rows[:, 2:]))
        print(f"  {name}: {off:.1e} of the largest off the fixture")
        if not off <= 1e-9:
            sys.exit(1)
