"""One case of `sweep verify` with scikit-fem: linear viscoelasticity, with or without an obstacle, by linear or quadratic
elements.

    python scikit_fem.py [--rule trapezoid|rectangle] [--assemble] DIRECTORY

Reads the files of DIRECTORY (its README.md says what they mean) and writes displacement.npy and,
where there is contact, pressure.npy. `--rule rectangle` is a deliberate mistake: memory integrals by the
left-hand rectangle rule, of order 1. `--assemble` takes the loads as functions (`sweep verify --loads density`).

    pip install scikit-fem==12.0.2 scipy numpy
"""
import argparse
import json
from pathlib import Path

import numpy as np
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementTriP1, ElementTriP2, ElementVector, MeshTri
from skfem.helpers import ddot, sym_grad, trace

MOST_CHANGES = 100


def stiffness(basis, law):
    """(2 μ ε(u) + λ tr ε(u) I, ε(v))."""

    @BilinearForm
    def product(u, v, w):
        strain, test = sym_grad(u), sym_grad(v)
        return 2 * law["mu"] * ddot(strain, test) + law["lambda"] * trace(strain) * trace(test)

    return product.assemble(basis).tocsc()


ELEMENTS = {"P1": ElementTriP1, "P2": ElementTriP2}


def basis_and_unknowns(name, points, cells):
    """The basis of an element on cells by corners and midpoints, and its unknown of each component of each row of vertices.csv."""
    corners, midpoints = cells[:3], cells[3:]
    mesh = MeshTri(points[:, : corners.max() + 1], corners)
    basis = Basis(mesh, ElementVector(ELEMENTS[name]()))
    if not len(midpoints):
        return basis, basis.nodal_dofs.T.ravel()
    # Midpoints are known by the ends of their edges, which the mesh numbers in an order of its own.
    ends = np.sort(corners[[[0, 1], [1, 2], [2, 0]]], axis=1)
    midpoint = {(a, b): m for edge, row in zip(ends, midpoints) for a, b, m in zip(*edge, row)}
    unknowns = np.empty((points.shape[1], 2), int)
    unknowns[[midpoint[a, b] for a, b in mesh.facets.T]] = basis.facet_dofs.T
    unknowns[: mesh.p.shape[1]] = basis.nodal_dofs.T
    return basis, unknowns.ravel()


def assembled(directory, cells, facets, area, length, size):
    """∫ f0·v + ∫ f2·v of all levels for linear elements, from the values at the points of the rules."""
    loads = 0
    for name, nodes, measure in [("cell", cells, area), ("facet", facets, length)]:
        rule, values = np.load(directory / f"{name}_rule.npy"), np.load(directory / f"{name}_loads.npy")
        # Barycentric coordinates are the hat functions; the last column has the weights.
        shares = np.einsum("s,q,qa,nsqi->nsai", measure, rule[:, -1], rule[:, :-1], values)
        part = np.zeros((len(values), size, values.shape[-1]))
        np.add.at(part, (slice(None), nodes), shares)
        loads = loads + part
    return loads.reshape(len(loads), -1)


def table(path):
    return np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8", ndmin=1)


class Case:
    def __init__(self, directory, assemble):
        self.directory = directory
        self.case = json.loads((directory / "case.json").read_text())
        self.refuse_what_is_not_here()
        vertices, cells = table(directory / "vertices.csv"), table(directory / "cells.csv")
        points = np.stack([vertices["x"], vertices["y"]])
        nodes = [name for name in cells.dtype.names if name.startswith("v")]
        cells = np.stack([cells[name] for name in nodes])
        basis, unknowns = basis_and_unknowns(self.case["element"], points, cells)
        # From here on component c of row i of vertices.csv is unknown 2 i + c.
        matrix = lambda law: stiffness(basis, law)[unknowns][:, unknowns]
        self.elastic = matrix(self.case["elasticity"][0])
        self.memory = [matrix(term[0]) for term in self.case["memory"]]
        self.free = np.flatnonzero(np.repeat(vertices["clamped"] == 0, 2))
        self.times = np.load(directory / "times.npy")
        self.kernels = np.load(directory / "kernels.npy") if self.memory else []
        if assemble:
            self.assemble(points, cells)
        else:
            self.loads = np.load(directory / "loads.npy").reshape(len(self.times), -1)
        self.read_contact()

    def assemble(self, points, cells):
        if self.case["element"] != "P1":
            raise SystemExit("this solver assembles loads for linear elements alone")
        rows = table(self.directory / "facets.csv")
        facets = np.stack([rows["v0"], rows["v1"]], axis=1)
        a, b, c = (points[:, corner] for corner in cells)
        area = 0.5 * np.abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
        length = np.linalg.norm(np.diff(points[:, facets], axis=2)[..., 0], axis=0)
        self.loads = assembled(self.directory, cells.T, facets, area, length, points.shape[1])

    def refuse_what_is_not_here(self):
        case = self.case
        contact = case["contact"] or {}
        # A list where sides have laws of their own.
        tables = contact if isinstance(contact, list) else [contact]
        laws = [table["law"]["kind"] for table in tables if "law" in table]
        for refused, what in [
            (case["dimension"] != 2, "bodies in space"),
            (case["projection"] is not None, "a projection"),
            (len(case["regions"]) > 1, "regions"),
            (any("mandel" in tensor for tensor in case["elasticity"]), "full tensors"),
            (set(laws) - {"none"}, f"the law {', '.join(laws)}"),
            ((self.directory / "gap.npy").exists(), "an obstacle that moves"),
            (any("friction" in table for table in tables), "friction"),
            (any(case["singular"]), "kernels that are infinite at lag zero"),
            (not case["uniform"], "a grid that is not uniform"),
        ]:
            if refused:
                raise SystemExit(f"this solver does not have {what}")

    def read_contact(self):
        rows = table(self.directory / "contact.csv") if self.case["contact"] else []
        self.rows = len(rows)
        if not self.rows:
            return
        inside = np.flatnonzero((rows["clamped"] == 0) & np.isfinite(rows["gap"]))
        normal = np.stack([rows["nx"], rows["ny"]], axis=1)[inside]
        axis = np.abs(normal).argmax(axis=1)
        self.sign = normal[np.arange(len(inside)), axis]
        if not np.isclose(np.abs(self.sign), 1.0).all():
            raise SystemExit("this solver does not have normals that are no axes")
        self.inside, self.unknown = inside, 2 * rows["vertex"][inside] + axis
        self.gap, self.weight = rows["gap"][inside], rows["weight"][inside]

    def weights(self, n, rule):
        """The weights of levels 0 … n in the integral up to t_n."""
        weights, k = np.zeros(n + 1), np.diff(self.times[: n + 1])
        weights[:-1] += k if rule == "rectangle" else k / 2
        weights[1:] += 0 if rule == "rectangle" else k / 2
        return weights

    def march(self, rule):
        u = np.zeros_like(self.loads)
        pressure = np.zeros((len(self.times), self.rows))
        active = np.zeros(len(self.unknown), bool) if self.rows else None
        for n in range(len(self.times)):
            weights = self.weights(n, rule)
            operator, force = self.elastic, self.loads[n].copy()
            for kernel, memory in zip(self.kernels, self.memory):
                lags = weights * kernel[n::-1]
                operator = operator + lags[n] * memory
                force -= memory @ (lags[:n] @ u[:n])
            if not self.rows:
                u[n, self.free] = splu(operator[self.free][:, self.free]).solve(force[self.free])
                continue
            u[n], active, reaction = self.obstacle(operator.tocsc(), force, active)
            pressure[n, self.inside] = reaction
        return u.reshape(len(self.times), -1, 2), pressure

    def obstacle(self, operator, force, active):
        """u_ν ≤ g by the primal-dual active set method; returns u, the active set, λ."""
        for _ in range(MOST_CHANGES):
            held = self.unknown[active]
            u = np.zeros(len(force))
            u[held] = (self.sign * self.gap)[active]
            left = np.setdiff1d(self.free, held)
            matrix = operator[left]
            u[left] = splu(matrix[:, left].tocsc()).solve(force[left] - matrix @ u)
            residual = (force - operator @ u)[self.unknown]
            multiplier = np.where(active, self.sign * residual / self.weight, 0.0)
            penetrates = self.sign * u[self.unknown] > self.gap
            now = np.where(active, multiplier > 0, penetrates)
            if (now == active).all():
                return u, active, multiplier
            active = now
        raise SystemExit(f"the active set changed {MOST_CHANGES} times")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--rule", choices=["trapezoid", "rectangle"], default="trapezoid")
    parser.add_argument("--assemble", action="store_true")
    parser.add_argument("directory", type=Path)
    arguments = parser.parse_args()
    case = Case(arguments.directory, arguments.assemble)
    u, pressure = case.march(arguments.rule)
    np.save(arguments.directory / "displacement.npy", u)
    if case.rows:
        np.save(arguments.directory / "pressure.npy", pressure)


if __name__ == "__main__":
    main()
