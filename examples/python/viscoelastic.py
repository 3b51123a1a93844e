"""Linear viscoelasticity with scikit-fem, P1 or P2, for a case in process or, as a program, for one in a directory of files.

    gronwall.verify("viscoelastic", solve)
    sweep verify viscoelastic --solver 'python viscoelastic.py'
"""

import csv
import json
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementTriP1, ElementTriP2, ElementVector, MeshTri
from skfem.helpers import ddot, sym_grad, trace


def stiffness(basis, law):
    @BilinearForm
    def product(u, v, w):
        strain, test = sym_grad(u), sym_grad(v)
        return 2 * law["mu"] * ddot(strain, test) + law["lambda"] * trace(strain) * trace(test)

    return product.assemble(basis).tocsc()


def basis_and_unknowns(case):
    """The basis on the mesh, and its unknown of each component of each point of the case."""
    corners, midpoints = case.cells[:, :3], case.cells[:, 3:]
    vertices = len(case.points) - case.data["midpoints"]
    mesh = MeshTri(case.points[:vertices].T.copy(), corners.T.copy())
    basis = Basis(mesh, ElementVector(ElementTriP2() if case.data["element"] == "P2" else ElementTriP1()))
    unknowns = np.empty((len(case.points), 2), int)
    unknowns[:vertices] = basis.nodal_dofs.T
    if len(case.points) > vertices:
        # The mesh numbers its edges itself; midpoints are known by the ends of theirs.
        ends = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2))
        row = dict(zip(map(tuple, ends), midpoints.ravel()))
        unknowns[[row[a, b] for a, b in mesh.facets.T]] = basis.facet_dofs.T
    return basis, unknowns.ravel()


def solve(case, rule="trapezoid"):
    """One linear system a level: the history of all earlier levels is on its right side."""
    basis, unknowns = basis_and_unknowns(case)
    by_points = lambda law: stiffness(basis, law)[unknowns][:, unknowns]
    elastic = by_points(case.data["elasticity"][0])
    memory = [by_points(term[0]) for term in case.data["memory"]]
    free = np.flatnonzero(np.repeat(~case.clamped, 2))
    loads, k = case.loads.reshape(len(case.times), -1), case.times[1]
    last = 0.0 if rule == "rectangle" else 0.5 * k
    u = np.zeros_like(loads)
    for n in range(len(case.times)):
        weights = np.full(n + 1, k)
        weights[0] = weights[0] if rule == "rectangle" else 0.5 * k
        weights[n] = last if n else 0.0
        right, matrix = loads[n].copy(), elastic
        for term, kernel in zip(memory, case.kernels if memory else []):
            right -= term @ ((weights[:n] * kernel[n:0:-1]) @ u[:n])
            matrix = matrix + weights[n] * kernel[0] * term
        u[n, free] = splu(matrix[free][:, free].tocsc()).solve(right[free])
    return u.reshape(case.loads.shape)


def read(directory):
    """The case in a directory, with the names of `gronwall.Case`."""

    def table(name, columns, kind):
        with open(directory / name, newline="") as file:
            return np.array([[kind(row[column]) for column in columns] for row in csv.DictReader(file)])

    data = json.loads((directory / "case.json").read_text())
    nodes = 6 if data["element"] == "P2" else 3
    return SimpleNamespace(
        data=data,
        points=table("vertices.csv", ["x", "y"], float),
        clamped=table("vertices.csv", ["clamped"], int)[:, 0].astype(bool),
        cells=table("cells.csv", [f"v{i}" for i in range(nodes)], int),
        times=np.load(directory / "times.npy"),
        kernels=np.load(directory / "kernels.npy") if data["memory"] else None,
        loads=np.load(directory / "loads.npy"),
    )


if __name__ == "__main__":
    directory = Path(sys.argv[1])
    np.save(directory / "displacement.npy", solve(read(directory)))
