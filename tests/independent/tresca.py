"""The scene tresca.toml by another method: P1 elements from edge vectors, the memory summed level by level, and friction
as a quadratic problem in the friction stresses alone, with bounds, solved by coordinate descent.

usage: tresca.py N STEPS [FIXTURE]    prints u_N and s_N as JSON, or compares them with those of FIXTURE (1e-9 of the largest)
"""

import json
import math
import sys

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

LAME, SHEAR = 1.0, 0.8
REMEMBERED = (0.25, 0.3)
STIFFNESS = 0.7


def kernel(lag):
    return -0.5 * math.exp(-2.0 * lag)


def bound(x, t):
    return 0.05 * (1.0 + 6.0 * x) * (1.0 + t / 2.0)


def triangles(n):
    """Squares cut from lower left to upper right; vertex (i, j) has the number j (n + 1) + i."""
    for j in range(n):
        for i in range(n):
            a = j * (n + 1) + i
            b, c, d = a + 1, a + n + 2, a + n + 1
            yield a, b, c
            yield a, c, d


def stiffness(n, lame, shear):
    """K of 2 mu eps:eps + lambda div div, from B matrices in engineering strains."""
    law = np.array([[lame + 2 * shear, lame, 0], [lame, lame + 2 * shear, 0], [0, 0, shear]])
    rows, columns, values = [], [], []
    for corners in triangles(n):
        x = np.array([[v % (n + 1) / n, v // (n + 1) / n] for v in corners])
        gradient = np.linalg.inv(np.column_stack([np.ones(3), x]))[1:]
        area = 0.5 / n**2
        b = np.zeros((3, 6))
        b[0, 0::2], b[1, 1::2] = gradient[0], gradient[1]
        b[2, 0::2], b[2, 1::2] = gradient[1], gradient[0]
        dofs = [2 * v + i for v in corners for i in (0, 1)]
        rows.extend(np.repeat(dofs, 6))
        columns.extend(np.tile(dofs, 6))
        values.extend((area * b.T @ law @ b).ravel())
    order = 2 * (n + 1) ** 2
    return coo_matrix((values, (rows, columns)), shape=(order, order)).tocsc()


def body_load(n, force):
    load = np.zeros(2 * (n + 1) ** 2)
    for corners in triangles(n):
        for v in corners:
            load[2 * v : 2 * v + 2] += np.array(force) / (6 * n**2)
    return load


def sliding(compliance, free, limits):
    """The s in the box with free - compliance s in its normal cone: the minimum of s·C s/2 - s·free, one s after the other."""
    s = np.zeros(len(free))
    for _ in range(100_000):
        before = s.copy()
        for i in range(len(s)):
            rest = free[i] - compliance[i] @ s + compliance[i, i] * s[i]
            s[i] = min(max(rest / compliance[i, i], -limits[i]), limits[i])
        # A few units of rounding of the largest keep the last digits moving.
        if np.max(np.abs(s - before)) <= 1e-15 * np.max(limits):
            return s
    sys.exit("coordinate descent does not end")


def solve(n, steps):
    k = 1.0 / steps
    elastic, memory = stiffness(n, LAME, SHEAR), stiffness(n, *REMEMBERED)
    unknowns = np.arange(2 * n * (n + 1))
    bottom = np.arange(n + 1)
    weights = np.full(n + 1, 1.0 / n)
    weights[[0, -1]] /= 2
    layer = coo_matrix((STIFFNESS * weights, (2 * bottom + 1, 2 * bottom + 1)), shape=elastic.shape)
    past = []
    for level in range(steps + 1):
        t = level * k
        last_weight = k / 2 if level > 0 else 0.0
        matrix = (elastic + layer.tocsc() + last_weight * kernel(0.0) * memory)[unknowns][:, unknowns]
        load = body_load(n, (0.4 * t, -0.2))
        for j, u in enumerate(past):
            weight = k / 2 if j == 0 else k
            load -= weight * kernel(t - j * k) * (memory @ u)
        factor = splu(matrix.tocsc())
        unit = np.zeros((len(unknowns), n + 1))
        unit[2 * bottom, bottom] = weights
        answers = factor.solve(unit)
        free = factor.solve(load[unknowns])
        limits = np.array([bound(x / n, t) for x in range(n + 1)])
        s = sliding(answers[2 * bottom], free[2 * bottom], limits)
        u = np.zeros(elastic.shape[0])
        u[unknowns] = free - answers @ s
        past.append(u)
    return past[-1].reshape(-1, 2), s


def main():
    n, steps = int(sys.argv[1]), int(sys.argv[2])
    u, s = solve(n, steps)
    if len(sys.argv) == 3:
        json.dump({"n": n, "steps": steps, "u": u.tolist(), "friction": s.tolist()}, sys.stdout)
        return
    with open(sys.argv[3]) as file:
        known = json.load(file)
    for name, here in (("u", u), ("friction", s)):
        off = np.max(np.abs(here - np.array(known[name]))) / np.max(np.abs(here))
        print(f"  {name}: {off:.1e} of the largest off the fixture")
        if not off <= 1e-9:
            sys.exit(1)


main()
