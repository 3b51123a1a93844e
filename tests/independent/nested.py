"""The scenes nested-left and short-memory by another method: double sums written out, loads by Gauss's rule within Gauss's rule,
and each level by bisection, without derivatives and without an active set.

usage: nested.py [FIXTURE]    prints u_0, …, u_N as JSON, or compares them with those of FIXTURE (1e-9 of the largest)
"""

import json
import math
import sys

import numpy as np

STEPS = 16
# 24 points are exact to rounding for the kernels here, which are entire functions on [0, 1].
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(24)


def integral(f, a, b):
    """The integral of a vector function over [a, b]."""
    half = 0.5 * (b - a)
    return sum((half * w * f(a + half * (1 + x)) for x, w in zip(POINTS, WEIGHTS)), np.zeros(2))


def law(r):
    """0 up to 0, then 2 r up to 0.04, then falling with 1/2 up to 0.10, then 0.05."""
    return float(np.interp(r, [0.0, 0.04, 0.10], [0.0, 0.08, 0.05]))


class NestedLeft:
    """M u + g(u) + 3 Q int e^{-(t-s)} int (1 + s tau) u(tau) dtau ds + 0.8 p(-u_2) (0, -1) = f, rectangles at left ends."""

    matrix = np.array([[3.0, 0.5], [0.2, 2.0]])
    weight = 0.8
    shares = (1.0, 0.0)
    start = np.zeros(2)
    constant = np.zeros(2)
    # q, r (None: the history of u itself) and Q.
    terms = [(lambda t, s: 3 * math.exp(s - t), lambda s, tau: 1 + s * tau, np.array([[1.0, 0.2], [-0.3, 0.8]]))]

    def bent(self, u):
        return np.array([0.5 * math.tanh(u[0]), 0.0])

    def exact(self, t):
        return np.array([math.sin(2 * t) + 0.3, -0.09 * t * t])


class ShortMemory:
    """C w + A u + int B(t-s) u(s) ds + p(-w_2) (0, -1) = f with u = u0 + int w, backward Euler."""

    matrix = np.array([[2.0, 0.3], [0.3, 1.5]])
    weight = 1.0
    shares = (0.0, 1.0)
    start = np.array([0.2, -0.1])
    elastic = np.array([[3.0, 0.5], [0.5, 2.0]])
    constant = np.array([3.0 * 0.2 - 0.5 * 0.1, 0.5 * 0.2 - 2.0 * 0.1])
    terms = [
        (lambda t, s: 1.0, None, elastic),
        (lambda t, s: -math.exp(s - t), lambda s, tau: 1.0, np.array([[0.8, 0.1], [0.1, 0.6]])),
    ]

    def bent(self, u):
        return np.zeros(2)

    def exact(self, t):
        return np.array([math.cos(3 * t), -0.09 * t * (2 - t)])


def forces(case, u, history):
    return case.matrix @ u + case.bent(u) + history + case.weight * law(-u[1]) * np.array([0.0, -1.0])


def load(case, t):
    """f(t) of the exact solution."""
    history = case.constant.copy()
    for q, r, matrix in case.terms:
        def inner(s):
            return case.exact(s) if r is None else case.start + integral(lambda tau: r(s, tau) * case.exact(tau), 0.0, s)
        history = history + matrix @ integral(lambda s: q(t, s) * inner(s), 0.0, t)
    return forces(case, case.exact(t), history)


def root(f, low, high):
    """The root of an increasing function, to the last digit."""
    while True:
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            return middle
        low, high = (middle, high) if f(middle) < 0 else (low, middle)


def sums(case, times, u):
    """The history at the last of the times by the double sums, u_0, …, u_n given."""
    n, (left, right) = len(u) - 1, case.shares

    def weight(n, j):
        before = times[j] - times[j - 1] if j > 0 else 0.0
        after = times[j + 1] - times[j] if j < n else 0.0
        return left * after + right * before

    total = case.constant.copy()
    for q, r, matrix in case.terms:
        outer = np.zeros(2)
        for j in range(n + 1):
            v = u[j]
            if r is not None:
                v = case.start + sum((weight(j, i) * r(times[j], times[i]) * u[i] for i in range(j + 1)), np.zeros(2))
            outer = outer + weight(n, j) * q(times[n], times[j]) * v
        total = total + matrix @ outer
    return total


def march(case):
    times, u = [n / STEPS for n in range(STEPS + 1)], []
    for n, t in enumerate(times):
        f = load(case, t)

        def left_over(first, second):
            now = np.array([first, second])
            return forces(case, now, sums(case, times[: n + 1], u + [now])) - f

        # What is affine in u_n enters by two evaluations, so that bisection stays cheap.
        base = sums(case, times[: n + 1], u + [np.zeros(2)])
        slot = np.array([sums(case, times[: n + 1], u + [e]) - base for e in np.eye(2)]).T

        def balance(now):
            return forces(case, now, base + slot @ now) - f

        def first(second):
            return root(lambda x: balance(np.array([x, second]))[0], -10.0, 10.0)

        second = root(lambda y: balance(np.array([first(y), y]))[1], -10.0, 10.0)
        assert np.abs(left_over(first(second), second)).max() < 1e-13
        u.append(np.array([first(second), second]))
    return [list(level) for level in u]


CASES = {"nested-left": NestedLeft, "short-memory": ShortMemory}


def main(arguments):
    found = {name: march(case()) for name, case in CASES.items()}
    if not arguments:
        print(json.dumps({"steps": STEPS, **found}, indent=1))
        return 0
    with open(arguments[0]) as file:
        known = json.load(file)
    off = 0.0
    for name, levels in found.items():
        a, b = np.array(levels), np.array(known[name])
        off = max(off, np.abs(a - b).max() / np.abs(b).max())
    print(f"{off:.1e} of the largest")
    return 0 if off <= 1e-9 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
