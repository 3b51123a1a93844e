"""The scenes friction-*.toml by another method, in the plane and in space: linear simplices with gradients by inverse
matrices, the memory summed level by level, the projection by successive substitution, and contact with friction vertex after
vertex, on the displacements of the contact side alone: pressures that are projected, no derivatives and no active set.

usage: friction.py [FIXTURE]    prints u_N and s_N by places as JSON, or compares them with those of FIXTURE (1e-9 of the largest)
"""

import itertools
import json
import math
import sys

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

# Pressures move by no more than this share of the largest when they are taken as found.
STILL = 1e-14


class Case:
    """What the scenes have in common; each has another body force, an affine function of the place."""

    lame, shear = 1.0, 1.0
    remembered = (0.25, 0.25)
    projected = 0.0
    gap = math.inf
    # u_nu = 0 in place of a law and a gap.
    bilateral = False
    # Of the law of the normal pressure.
    steepest = 2.0

    def kernel(self, lag):
        return -0.5 * math.exp(-2.0 * lag)

    def kappa(self, zeta):
        return 0.10 + 0.05 * zeta


class Coulomb(Case):
    """The bound follows the pressure, on both branches of its law; at the gap it follows the law alone."""

    dimension, n, steps = 2, 8, 6
    gap = 0.10
    coefficient = 0.4

    def pressure(self, u):
        return np.interp(u, [0.0, 0.04, 0.10], [0.0, 0.08, 0.05])

    def body(self, p, t):
        x, y = p
        return [0.5 * t * (x - 0.3), -0.6 * x * (1 + t) + 0.1 * t * y]

    def bound(self, p, t, pressure, slip):
        return self.coefficient * pressure


class Falling(Case):
    """The bound falls with the slip."""

    dimension, n, steps = 2, 8, 6

    def pressure(self, u):
        return 0.7 * u

    def body(self, p, t):
        x, y = p
        return [0.4 * t * (x - 0.2), -0.1 * t * (1 + y)]

    def bound(self, p, t, pressure, slip):
        return np.interp(slip, [0.0, 0.1], [0.06, 0.04])


class Bilateral(Case):
    """Nothing depends on the past, u_nu = 0 on the bottom, and the bound falls with the slip as fast as (2.9) allows."""

    dimension, n, steps = 2, 8, 1
    remembered = (0.0, 0.0)
    bilateral = True

    def pressure(self, u):
        return 0.0 * u

    def body(self, p, t):
        x, y = p
        return [0.5 * (x - 0.2) + 0.1 * y, 0.6 * (0.5 - x) - 0.2 * y]

    def bound(self, p, t, pressure, slip):
        return np.interp(slip, [0.0, 0.1], [0.08, 0.03])


class Box(Case):
    """A given bound on the foot of a cube that is pulled in directions that turn from place to place."""

    dimension, n, steps = 3, 4, 3

    def pressure(self, u):
        return np.interp(u, [0.0, 0.04, 0.10], [0.0, 0.08, 0.05])

    def body(self, p, t):
        x, y, z = p
        return [0.4 * t * (z - 0.3), -0.1 * (1 + x), 0.4 * t * (0.7 - x) + 0.1 * t * y]

    def bound(self, p, t, pressure, slip):
        return 0.04 * (1 + 3 * p[0]) * (1 + t / 2)


class BoxCoulomb(Box):
    """In space the bound follows the pressure."""

    coefficient = 0.3

    def body(self, p, t):
        x, y, z = p
        return [0.07 * t * (z - 0.3), -0.2 * (1 + x), 0.07 * t * (0.7 - x) + 0.05 * t * y]

    def bound(self, p, t, pressure, slip):
        return self.coefficient * pressure


class BoxFalling(Box):
    """In space the bound falls with the length of the slip."""

    def pressure(self, u):
        return 0.7 * u

    def bound(self, p, t, pressure, slip):
        return np.interp(slip, [0.0, 0.05], [0.1, 0.09])


class BoxTime(Case):
    """A face that sticks, and then slips in a direction that turns with time, in a body that yields in part."""

    dimension, n, steps = 3, 2, 6
    projected = 1.0

    def pressure(self, u):
        return 0.0 * u

    def body(self, p, t):
        x, y, z = p
        turn = 0.5 + t
        return [0.5 * t * math.cos(turn), 0.1 * t * (z - y), 0.5 * t * math.sin(turn) + 0.2 * t * x]

    def bound(self, p, t, pressure, slip):
        return 0.05 * (1 + 3 * p[0] + 3 * p[2])


CASES = {
    "coulomb": Coulomb(),
    "falling": Falling(),
    "bilateral": Bilateral(),
    "box": Box(),
    "box-coulomb": BoxCoulomb(),
    "box-falling": BoxFalling(),
    "box-time": BoxTime(),
}


class Mesh:
    """The unit cube in d dimensions: cells x_1 >= x_2 >= ... of each small cube, in all orders of the axes."""

    def __init__(self, d, n):
        self.d, self.n = d, n
        places = [p[::-1] for p in itertools.product(range(n + 1), repeat=d)]
        number = {p: v for v, p in enumerate(places)}
        self.places = np.array(places) / n
        self.cells = []
        for corner in itertools.product(range(n), repeat=d):
            for order in itertools.permutations(range(d)):
                path = [corner]
                for axis in order:
                    path.append(tuple(c + (a == axis) for a, c in enumerate(path[-1])))
                self.cells.append([number[p] for p in path])
        self.volume = 1.0 / n**d / math.factorial(d)
        self.gradients = []
        for cell in self.cells:
            rows = np.column_stack([np.ones(d + 1), self.places[cell]])
            self.gradients.append(np.linalg.inv(rows)[1:])
        self.dofs = d * len(places)
        self.free = np.repeat(self.places[:, 1] < 1.0, d).nonzero()[0]
        self.bottom = (self.places[:, 1] == 0.0).nonzero()[0]
        self.weights = np.zeros(len(places))
        for cell in self.cells:
            facet = [v for v in cell if self.places[v, 1] == 0.0]
            if len(facet) == d:
                self.weights[facet] += 1.0 / n ** (d - 1) / math.factorial(d - 1) / d

    def stiffness(self, lame, shear):
        d, rows, columns, values = self.d, [], [], []
        for cell, g in zip(self.cells, self.gradients):
            both = g.T @ g
            block = lame * np.einsum("ia,jb->aibj", g, g) + shear * np.einsum("ja,ib->aibj", g, g)
            block += shear * np.einsum("ab,ij->aibj", both, np.eye(d))
            dofs = [d * v + i for v in cell for i in range(d)]
            rows.extend(np.repeat(dofs, len(dofs)))
            columns.extend(np.tile(dofs, len(dofs)))
            values.extend(self.volume * block.ravel())
        return coo_matrix((values, (rows, columns)), shape=(self.dofs, self.dofs)).tocsc()

    def load(self, force):
        """An affine force by the mass matrix of a simplex, volume (1 + delta)/((d + 1)(d + 2))."""
        d, out = self.d, np.zeros((len(self.places), self.d))
        at = np.array([force(p) for p in self.places])
        mass = self.volume / ((d + 1) * (d + 2)) * (np.ones((d + 1, d + 1)) + np.eye(d + 1))
        for cell in self.cells:
            out[cell] += mass @ at[cell]
        return out.ravel()

    def strains(self, u):
        u = u.reshape(-1, self.d)
        gradients = np.array([g @ u[cell] for cell, g in zip(self.cells, self.gradients)])
        return (gradients + gradients.transpose(0, 2, 1)) / 2

    def strain_norm(self, u):
        return math.sqrt(self.volume * np.sum(self.strains(u) ** 2))

    def excess(self, u, limit):
        """Nodal forces of e - P e, P onto strains whose deviator is at most `limit`."""
        strains = self.strains(u)
        trace = np.einsum("cii->c", strains) / self.d
        deviators = strains - trace[:, None, None] * np.eye(self.d)
        sizes = np.sqrt(np.sum(deviators**2, axis=(1, 2)))
        over = np.maximum(1.0 - limit / np.maximum(sizes, limit), 0.0)
        out = np.zeros((len(self.places), self.d))
        for cell, g, e in zip(self.cells, self.gradients, over[:, None, None] * deviators):
            out[cell] += self.volume * g.T @ e
        return out.ravel()


class Side:
    """The contact side: its displacements (u_nu, u_tau) are `free` minus compliance times the pressures (q, s)."""

    def __init__(self, mesh, factor, case):
        self.mesh, self.case = mesh, case
        d = mesh.d
        axes = [1] + [i for i in range(d) if i != 1]
        self.signs = np.tile([-1.0] + [1.0] * (d - 1), len(mesh.bottom))
        dofs = np.array([d * v + i for v in mesh.bottom for i in axes])
        # Clamped unknowns come last in no order: those of the bottom are all free.
        self.at = np.searchsorted(mesh.free, dofs)
        pushes = np.zeros((len(mesh.free), len(dofs)))
        pushes[self.at, np.arange(len(dofs))] = self.signs * np.repeat(mesh.weights[mesh.bottom], d)
        self.answers = factor.solve(pushes)
        self.compliance = self.signs[:, None] * self.answers[self.at]
        self.pressures = np.zeros(len(dofs))

    def settle(self, free, t):
        """The pressures of displacements that are `free` without any, one vertex after another."""
        d, case, f = self.mesh.d, self.case, self.pressures
        unloaded = self.signs * free[self.at]
        for _ in range(100_000):
            before = f.copy()
            for i, vertex in enumerate(self.mesh.bottom):
                q, s = d * i, slice(d * i + 1, d * i + d)
                u = unloaded[q] - self.compliance[q] @ f
                spring = self.compliance[q, q]
                law = case.pressure(u)
                pushed = f[q] + (u - case.gap) / spring
                followed = f[q] + (law - f[q]) / (1 + spring * case.steepest)
                f[q] = f[q] + u / spring if case.bilateral else max(followed, pushed)
                u = unloaded[s] - self.compliance[s] @ f
                spring = np.max(np.abs(np.diag(self.compliance)[s]))
                bound = case.bound(self.mesh.places[vertex], t, law, np.linalg.norm(u))
                pushed = f[s] + u / spring
                size = np.linalg.norm(pushed)
                f[s] = pushed if size <= bound else bound / size * pushed
            if np.max(np.abs(f - before)) <= STILL * np.max(np.abs(f)):
                self.examine(unloaded - self.compliance @ f, t)
                return free - self.answers @ f
        sys.exit(f"pressures do not settle: {np.max(np.abs(f - before)):.1e}")

    def examine(self, u, t):
        """The laws in words that the iteration does not use: |s| <= S, and s·u = S |u|."""
        d, f, slack = self.mesh.d, self.pressures.reshape(-1, self.mesh.d), 1e-13
        self.counts = [0, 0, 0]
        for vertex, (q, *s), (normal, *slip) in zip(self.mesh.bottom, f, u.reshape(-1, d)):
            law, slip = self.case.pressure(normal), np.array(slip)
            length = np.linalg.norm(slip)
            bound = self.case.bound(self.mesh.places[vertex], t, law, length)
            locked = normal > self.case.gap - slack
            if self.case.bilateral:
                assert abs(normal) <= slack
            else:
                assert normal <= self.case.gap + slack and q >= law - slack
                assert locked or abs(q - law) <= slack
            assert np.linalg.norm(s) <= bound + slack
            assert abs(np.dot(s, slip) - bound * length) <= slack
            self.counts[0] += length < 1e-12
            self.counts[1] += length >= 1e-12
            self.counts[2] += locked


def solve(case):
    mesh, k = Mesh(case.dimension, case.n), 1.0 / case.steps
    elastic, memory = mesh.stiffness(case.lame, case.shear), mesh.stiffness(*case.remembered)
    past, zeta, side = [], 0.0, None
    for level in range(case.steps + 1):
        t = level * k
        last_weight = k / 2 if level > 0 else 0.0
        if level < 2:
            matrix = (elastic + last_weight * case.kernel(0.0) * memory)[mesh.free][:, mesh.free]
            factor = splu(matrix.tocsc())
            side = Side(mesh, factor, case)
        load = mesh.load(lambda p: case.body(p, t))
        for j, u in enumerate(past):
            load -= (k / 2 if j == 0 else k) * case.kernel(t - j * k) * (memory @ u)
        u = past[-1].copy() if past else np.zeros(mesh.dofs)
        for _ in range(1000):
            limit = case.kappa(zeta + last_weight * mesh.strain_norm(u))
            forces = load - case.projected * mesh.excess(u, limit) if case.projected else load
            before = u
            u = np.zeros(mesh.dofs)
            u[mesh.free] = side.settle(factor.solve(forces[mesh.free]), t)
            if not case.projected or np.max(np.abs(u - before)) <= 1e-14 * np.max(np.abs(u)):
                break
        else:
            sys.exit("the projection does not settle")
        past.append(u)
        zeta += (k if level > 0 else k / 2) * mesh.strain_norm(u)
    yields = np.any(mesh.excess(past[-1], case.kappa(zeta - k / 2 * mesh.strain_norm(past[-1]))))
    sticks, slips, locked = side.counts
    told = f"{sticks} stick, {slips} slip, {locked} at the gap, the body {'yields' if case.projected and yields else 'is linear'}"
    shear = side.pressures.reshape(-1, mesh.d)[:, 1:]
    return told, {
        "n": case.n,
        "steps": case.steps,
        "u": np.hstack([mesh.places, past[-1].reshape(-1, mesh.d)]).tolist(),
        "friction": np.hstack([mesh.places[mesh.bottom], shear]).tolist(),
    }


def main():
    found = {}
    for name, case in CASES.items():
        told, found[name] = solve(case)
        print(f"  {name}: {told}", file=sys.stderr)
    if len(sys.argv) == 1:
        json.dump(found, sys.stdout)
        return
    with open(sys.argv[1]) as file:
        known = json.load(file)
    assert known.keys() == found.keys()
    for name, case in CASES.items():
        for key in ("u", "friction"):
            here, other = np.array(found[name][key]), np.array(known[name][key])
            off = np.max(np.abs(here - other)) / np.max(np.abs(here[:, case.dimension :]))
            print(f"  {name}, {key}: {off:.1e} of the largest off the fixture")
            if not off <= 1e-9:
                sys.exit(1)


if __name__ == "__main__":
    main()
