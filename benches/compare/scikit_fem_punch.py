"""The benchmark scene "punch" with scikit-fem: contact, projection and memory in plane strain.

    python scikit_fem_punch.py VARIANT N STEPS [--json]

VARIANT is punch, elastic-punch or linear-punch. Prints the quantities at t = T and the CPU
seconds of mesh, assembly and all steps (imports excluded), on one thread. The direct solver is
CHOLMOD if scikit-sparse is installed, else scipy's SuperLU.

    apt-get install libsuitesparse-dev libopenblas0-serial   # the reference BLAS is 1.5x slower
    pip install scikit-fem==12.0.2 scikit-sparse==0.4.16
"""
import os

for library in ("OMP", "OPENBLAS", "MKL", "BLIS", "NUMEXPR"):
    os.environ[f"{library}_NUM_THREADS"] = "1"

import argparse
import json
import time

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix
from scipy.sparse.linalg import splu
from skfem import (Basis, BilinearForm, ElementTriP0, ElementTriP1, ElementVector, FacetBasis,
                   LinearForm, MeshTri)
from skfem.helpers import ddot, sym_grad, trace

try:
    from sksparse.cholmod import analyze
except ImportError:
    analyze = None

LAMBDA, MU = 1.0, 1.0
MEMORY_LAMBDA, MEMORY_MU = 0.25, 0.25
YIELD_LIMIT, HARDENING = 0.10, 0.05
GAP = 0.10
TOLERANCE, MOST_ITERATIONS = 1e-10, 40


@BilinearForm
def strain_product(u, v, w):
    """(ε(u), ε(v))."""
    return ddot(sym_grad(u), sym_grad(v))


@BilinearForm
def trace_product(u, v, w):
    """(tr ε(u), tr ε(v))."""
    return trace(sym_grad(u)) * trace(sym_grad(v))


@BilinearForm
def stretch(u, q, w):
    """((ε_xx - ε_yy)/√2, q): first coordinate of the deviator."""
    strain = sym_grad(u)
    return (strain[0, 0] - strain[1, 1]) / np.sqrt(2) * q


@BilinearForm
def shear(u, q, w):
    """(√2 ε_xy, q): second coordinate of the deviator."""
    return np.sqrt(2) * sym_grad(u)[0, 1] * q


@LinearForm
def body_force(v, w):
    """(f0, v) at t = 1."""
    return -3 * w.x[0] * v[1]


@LinearForm
def normal_trace(v, w):
    """∫ v_ν on Γ3, where ν = (0, -1)."""
    return -v[1]


def compliance(r):
    """p(r) and p'(r)."""
    pieces = [r <= 0, r <= 0.04, r <= 0.10]
    value = np.select(pieces, [0 * r, 2 * r, 0.08 - 0.5 * (r - 0.04)], 0.05)
    return value, np.select(pieces, [0.0, 2.0, -0.5], 0.0)


class System:
    """Symmetric matrices on the free unknowns, of one pattern that is analysed once."""

    def __init__(self, whole, free):
        numbered = csr_matrix((np.arange(whole.nnz), whole.indices, whole.indptr), whole.shape)
        part = csc_matrix(numbered[free][:, free])
        part.sort_indices()
        self.taken, self.indices, self.indptr = part.data, part.indices, part.indptr
        self.order = len(free)
        self.columns = np.repeat(np.arange(self.order), np.diff(self.indptr))
        self.diagonal = np.flatnonzero(self.indices == self.columns)
        self.symbolic, self.factorizations = None, 0

    def positions(self, rows, columns):
        """Where entries stand in the data."""
        return np.searchsorted(self.columns * self.order + self.indices,
                               columns * self.order + rows)

    def matrix(self, data):
        return csc_matrix((data, self.indices, self.indptr), (self.order, self.order))

    def factor(self, data, pinned):
        """Factors the matrix, with rows and columns of `pinned` replaced by the identity's."""
        if len(pinned):
            keep = np.ones(self.order)
            keep[pinned] = 0.0
            data = data * keep[self.indices] * keep[self.columns]
            data[self.diagonal[pinned]] = 1.0
        self.factorizations += 1
        matrix = self.matrix(data)
        if analyze is None:
            return splu(matrix, "MMD_AT_PLUS_A", 0.0, options={"SymmetricMode": True}).solve
        if self.symbolic is None:
            self.symbolic = analyze(matrix, "supernodal", ordering_method="amd")
        self.symbolic.cholesky_inplace(matrix)
        return self.symbolic


class Projection:
    """ε - P_κ ε: its force, the derivatives by ε and κ, in two coordinates of the deviator."""

    def __init__(self, basis, system, free):
        constants = basis.with_element(ElementTriP0())
        self.area = basis.dx.sum(axis=1)
        local = [form.coo_data(basis, constants).tolocal()[:, 0] for form in (stretch, shear)]
        self.deviator = np.stack(local, axis=1) / self.area[:, None, None]
        self.unknowns = basis.element_dofs.T
        number = np.full(basis.N, -1)
        number[free] = np.arange(len(free))
        rows, columns = np.repeat(number[self.unknowns], 6, 1), np.tile(number[self.unknowns], 6)
        inside = (rows >= 0) & (columns >= 0)
        # Entries of fixed unknowns are collected behind the data.
        self.entry = np.full(rows.shape, len(system.indices))
        self.entry[inside] = system.positions(rows[inside], columns[inside])
        self.shape = basis.N, len(system.indices)

    def update(self, u, kappa):
        """Finds the yielding elements; their r = κ/|ε^D| and n = ε^D/|ε^D|."""
        strain = (self.deviator @ u[self.unknowns][:, :, None])[:, :, 0]
        length = np.hypot(strain[:, 0], strain[:, 1])
        self.at = np.flatnonzero(length > kappa)
        self.direction = strain[self.at] / length[self.at, None]
        self.ratio = kappa / length[self.at]
        self.stress = (1 - self.ratio)[:, None] * strain[self.at]

    def force(self, stress):
        """(stress, ε(v)) for all v, over the yielding elements."""
        weighted = (self.area[self.at, None] * stress)[:, None, :]
        local = (weighted @ self.deviator[self.at])[:, 0]
        return np.bincount(self.unknowns[self.at].ravel(), local.ravel(), self.shape[0])

    def tangent(self):
        """Data of the matrix of (1 - r) I + r n⊗n."""
        law = self.ratio[:, None, None] * self.direction[:, :, None] * self.direction[:, None, :]
        law += (1 - self.ratio)[:, None, None] * np.eye(2)
        deviator = self.deviator[self.at]
        local = deviator.swapaxes(1, 2) @ (self.area[self.at, None, None] * law) @ deviator
        return np.bincount(self.entry[self.at].ravel(), local.ravel(), self.shape[1] + 1)[:-1]


class Punch:
    """The discrete problem, and the work that its solution took."""

    def __init__(self, variant, n, steps):
        self.with_contact, self.steps, self.k = variant != "linear-punch", steps, 1 / steps
        line = np.linspace(0, 1, n + 1)
        self.mesh = MeshTri.init_tensor(line, line)
        element = ElementVector(ElementTriP1())
        basis = Basis(self.mesh, element, intorder=1)
        self.free = basis.complement_dofs(basis.get_dofs(lambda x: x[1] == 1))
        self.load = body_force.assemble(Basis(self.mesh, element, intorder=2))
        self.assemble(basis)
        ends = np.array([[0.0, 1.0]]), np.array([0.5, 0.5])
        bottom = self.mesh.facets_satisfying(lambda x: x[1] == 0)
        edges = FacetBasis(self.mesh, element, facets=bottom, quadrature=ends)
        lumped = normal_trace.assemble(edges)
        self.touching = np.flatnonzero(lumped)
        self.at_x = self.mesh.p[0, self.touching // 2]
        self.weight = -lumped[self.touching]
        self.gamma3 = np.searchsorted(self.free, self.touching)
        self.locked = np.zeros(len(self.touching), bool)
        self.projection = Projection(basis, self.system, self.free) if variant == "punch" else None
        self.factored, self.iterations = None, 0

    def assemble(self, basis):
        """Matrices of the strain product, elasticity and memory, all of one pattern."""
        forms = [form.coo_data(basis) for form in (strain_product, trace_product)]
        strain, traces = [csr_matrix((form.data, form.indices), form.shape) for form in forms]
        self.strain = strain
        self.elastic, self.memory = strain.copy(), strain.copy()
        self.elastic.data = 2 * MU * strain.data + LAMBDA * traces.data
        self.memory.data = 2 * MEMORY_MU * strain.data + MEMORY_LAMBDA * traces.data
        self.system = System(strain, self.free)

    def norm(self, u):
        """‖ε(u)‖."""
        return np.sqrt(max(u @ (self.strain @ u), 0.0))

    def march(self):
        """All steps; returns u_N and ζ_N. The exponential kernel carries its history along."""
        history, accumulated = np.zeros_like(self.load), 0.0
        previous = []
        for step in range(self.steps + 1):
            half = self.k / 2 if step else 0.0
            history *= np.exp(-self.k)
            force = step * self.k * self.load + self.memory @ history
            u = self.solve(self.extrapolated(previous), force, half, accumulated)
            size = self.norm(u)
            zeta = accumulated + half * size
            weight = self.k if step else self.k / 2
            history += weight * u
            accumulated += weight * size
            previous = [u, *previous[:2]]
        return u, zeta

    def extrapolated(self, previous):
        """The quadratic through the last three steps, or what there is."""
        if len(previous) == 3:
            return 3 * (previous[0] - previous[1]) + previous[2]
        return previous[0].copy() if previous else np.zeros_like(self.load)

    def solve(self, u, force, half, accumulated):
        """Semismooth Newton for one step, whose own weight in the history sums is `half`."""
        self.stiffness = self.elastic.data - half * self.memory.data
        operator = csr_matrix((self.stiffness, self.elastic.indices, self.elastic.indptr))
        bound = TOLERANCE * np.linalg.norm(force[self.free])
        for _ in range(MOST_ITERATIONS):
            size = self.norm(u) if self.projection else 0.0
            residual = operator @ u - force
            if self.projection:
                self.projection.update(u, YIELD_LIMIT + HARDENING * (accumulated + half * size))
                residual += self.projection.force(self.projection.stress)
            slope, penetration = self.contact(u, residual)
            if np.linalg.norm(residual[self.free]) <= bound and not penetration.any():
                return u
            u = u + self.increment(u, residual, slope, penetration, half, size)
            self.iterations += 1
        raise RuntimeError(f"no convergence in {MOST_ITERATIONS} Newton iterations")

    def contact(self, u, residual):
        """Adds compliance and multiplier to the residual, updates the locked vertices; returns
        w p' of the others and u_ν - g of the locked ones."""
        slope, penetration = np.zeros((2, len(self.touching)))
        self.reaction = residual[self.touching].sum()
        if not self.with_contact:
            return slope, penetration
        normal = -u[self.touching]
        pressure, derivative = compliance(normal)
        multiplier = residual[self.touching] / self.weight - pressure
        self.locked = np.where(self.locked, multiplier > 0, normal > GAP)
        residual[self.touching] -= self.weight * pressure
        residual[self.touching[self.locked]] = 0.0
        slope[~self.locked] = (self.weight * derivative)[~self.locked]
        penetration[self.locked] = normal[self.locked] - GAP
        penetration[np.abs(penetration) < 1e-14] = 0.0
        return slope, penetration

    def increment(self, u, residual, slope, penetration, half, size):
        """The Newton step; ∂κ/∂u has rank one and enters by the Sherman-Morrison formula."""
        yielding = self.projection and len(self.projection.at)
        pinned = self.gamma3[self.locked]
        key = half, slope.tobytes(), self.locked.tobytes()
        if yielding or self.factored != key:
            self.data = self.stiffness[self.system.taken]
            self.data[self.system.diagonal[self.gamma3]] += slope
            if yielding:
                self.data += self.projection.tangent()
            self.backsolve = self.system.factor(self.data, pinned)
            self.factored = None if yielding else key
        lift = np.zeros(len(self.free))
        lift[self.gamma3] = penetration
        right = -residual[self.free]
        if penetration.any():
            right -= self.system.matrix(self.data) @ lift
        right[pinned] = lift[pinned]
        step = np.zeros_like(u)
        if not (yielding and half):
            step[self.free] = self.backsolve(right)
            return step
        column = half * HARDENING * self.projection.force(-self.projection.direction)[self.free]
        column[pinned] = 0.0
        row = (self.strain @ u)[self.free] / size
        step_0, rank_one = self.backsolve(np.column_stack([right, column])).T
        step[self.free] = step_0 - rank_one * (row @ step_0) / (1 + row @ rank_one)
        return step

    def quantities(self, u, zeta):
        """What the scene asks for at t = T."""
        lowest = u[1::2].argmin()
        left, mid, right = [-u[self.touching[np.argmin(np.abs(self.at_x - x))]]
                            for x in (0, 0.5, 1)]
        return {
            "norm_eps": self.norm(u),
            "zeta": zeta,
            "min_uy": u[1::2].min(),
            "min_uy_vertex": self.mesh.p[:, lowest].tolist(),
            "unu_left": left,
            "unu_mid": mid,
            "unu_right": right,
            "contact_force": self.reaction if self.with_contact else 0.0,
            "locked_vertices": int(self.locked.sum()),
            "energy": 0.5 * u @ (self.elastic @ u),
            "newton_per_step": self.iterations / (self.steps + 1),
            "factorizations": self.system.factorizations,
        }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("variant", choices=["punch", "elastic-punch", "linear-punch"])
    parser.add_argument("n", type=int)
    parser.add_argument("steps", type=int)
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    begin = time.process_time()
    punch = Punch(arguments.variant, arguments.n, arguments.steps)
    solution = punch.march()
    seconds = time.process_time() - begin
    result = punch.quantities(*solution)
    result["cpu_seconds"] = seconds
    result["solver"] = "SuperLU" if analyze is None else "CHOLMOD"
    if arguments.json:
        print(json.dumps(result))
        return
    for name, value in result.items():
        print(f"{name:16} {value:.12g}" if isinstance(value, float) else f"{name:16} {value}")


if __name__ == "__main__":
    main()
