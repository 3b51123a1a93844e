"""c_j^2 = sup |v_nu|^2/|eps(v)|^2 and c_tau^2 on plane domains, twice: by scikit-fem's cubics on meshes that are graded
geometrically towards all vertices, and by its quadratics on meshes that follow their own error. Nothing of the program is
used. tests/numbers/trace_constants.rs has the numbers that this prints.

    pip install numpy scipy scikit-fem && python tests/independent/trace_constants.py [DOMAIN...]
"""

import sys

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from skfem import (Basis, BilinearForm, ElementTriP2, ElementTriP3, ElementVector, FacetBasis,
                   Functional, InteriorFacetBasis, MeshTri)
from skfem.helpers import ddot, dot, sym_grad

# Vertices counter-clockwise, triangles, the edges (by their first vertex) clamped and in contact.
DOMAINS = {
    "square": ([(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1, 2), (0, 2, 3)], [2], [0]),
    "small-clamp": ([(0, 0), (1, 0), (1, 1), (0.05, 1), (0, 1)], [(0, 1, 2), (0, 2, 3), (0, 3, 4)], [3], [0]),
    "wide": ([(-1, 0), (2, 0), (1, 1), (0, 1)], [(0, 1, 2), (0, 2, 3)], [2], [0]),
    "slot": ([(0, 0), (2, 0), (2, 0.4), (0.5, 0.4), (0.5, 0.6), (2, 0.6), (2, 1), (0, 1)],
             [(0, 1, 3), (1, 2, 3), (0, 3, 4), (0, 4, 7), (4, 5, 6), (4, 6, 7)], [6], [0]),
    "l": ([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], [(0, 1, 3), (1, 2, 3), (0, 3, 5), (3, 4, 5)], [4], [1]),
    "bar": ([(0, 0), (4, 0), (4, 1), (0, 1)], [(0, 1, 2), (0, 2, 3)], [3], [0]),
    "kite": ([(0, 0), (1, 0), (1.5, 2), (0.25, 0.5)], [(0, 1, 3), (1, 2, 3)], [1], [3]),
    "wedge": ([(0, 0), (1, 0), (0, 0.25)], [(0, 1, 2)], [2], [0]),
}


def domain(name):
    vertices, triangles, clamped, contact = DOMAINS[name]
    p = np.array(vertices, dtype=float).T
    mesh = MeshTri(p, np.array(triangles).T)

    def on(edges):
        def inside(x):
            found = np.zeros(x.shape[1], dtype=bool)
            for e in edges:
                a, b = p[:, e], p[:, (e + 1) % p.shape[1]]
                t = (b - a) / np.linalg.norm(b - a)
                off = t[0] * (x[1] - a[1]) - t[1] * (x[0] - a[0])
                along = t[0] * (x[0] - a[0]) + t[1] * (x[1] - a[1])
                found |= (abs(off) < 1e-12) & (along > 0) & (along < np.linalg.norm(b - a))
            return found
        return inside

    return mesh, p, on(clamped), on(contact)


@BilinearForm
def energy(u, v, _):
    return ddot(sym_grad(u), sym_grad(v))


@BilinearForm
def normal(u, v, w):
    return dot(u, w.n) * dot(v, w.n)


@BilinearForm
def tangential(u, v, w):
    along = lambda z: w.n[0] * z[1] - w.n[1] * z[0]
    return along(u) * along(v)


def largest(mesh, element, clamped, contact, square):
    basis = Basis(mesh, ElementVector(element))
    trace = FacetBasis(mesh, ElementVector(element), facets=mesh.facets_satisfying(contact, boundaries_only=True))
    stiffness, mass = energy.assemble(basis).tocsc(), square.assemble(trace).tocsc()
    free = basis.complement_dofs(basis.get_dofs(mesh.facets_satisfying(clamped, boundaries_only=True)))
    stiffness, mass = stiffness[free][:, free], mass[free][:, free]
    factor = splu(stiffness, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}, diag_pivot_thresh=0.0)
    inverse = LinearOperator(stiffness.shape, factor.solve)
    value, vector = eigsh(mass, 1, stiffness, Minv=inverse, tol=1e-13, v0=np.cos(np.arange(len(free))))
    field = np.zeros(basis.N)
    field[free] = vector[:, 0]
    return value[0], field, basis


def size(mesh):
    corners = mesh.p[:, mesh.t]
    return np.max([np.linalg.norm(corners[:, a] - corners[:, (a + 1) % 3], axis=0) for a in range(3)], axis=0)


def geometric(mesh, tips, width, nearest):
    """Cells are at most `width`, and half as large as they are far from a tip."""
    while True:
        centre, h = mesh.p[:, mesh.t].mean(axis=1), size(mesh)
        away = np.min(np.linalg.norm(centre[:, :, None] - tips[:, None, :], axis=0), axis=1)
        marked = np.flatnonzero((h > width) | ((h > 0.6 * away) & (h > nearest)))
        if len(marked) == 0:
            return mesh
        mesh = mesh.refined(marked)


def adaptive(mesh, clamped, contact, square, most):
    """Values and unknowns of quadratics; the cells with half of all jumps are refined again and again."""
    values = []
    while True:
        value, field, basis = largest(mesh, ElementTriP2(), clamped, contact, square)
        values.append((value, len(field)))
        if len(field) > most:
            return values
        # Jumps of the stress lead the refinement; what is left inside the cells follows them.
        indicator = np.zeros(mesh.t.shape[1])

        @Functional
        def jump(w):
            e = sym_grad(w["a"]) - sym_grad(w["b"])
            f = [e[i, 0] * w.n[0] + e[i, 1] * w.n[1] for i in range(2)]
            return w.h * (f[0] ** 2 + f[1] ** 2)
        sides = [InteriorFacetBasis(mesh, ElementVector(ElementTriP2()), side=i) for i in (0, 1)]
        eta = jump.elemental(sides[0], a=sides[0].interpolate(field), b=sides[1].interpolate(field))
        for i in (0, 1):
            np.add.at(indicator, mesh.f2t[i, sides[0].find], 0.5 * eta)

        def outer(w, load):
            e = sym_grad(w["a"])
            f = [e[i, 0] * w.n[0] + e[i, 1] * w.n[1] - load(w)[i] for i in range(2)]
            return w.h * (f[0] ** 2 + f[1] ** 2)
        def pressed(w):
            if square is normal:
                un = w["a"][0] * w.n[0] + w["a"][1] * w.n[1]
                return [un * w.n[0] / value, un * w.n[1] / value]
            ut = w.n[0] * w["a"][1] - w.n[1] * w["a"][0]
            return [-ut * w.n[1] / value, ut * w.n[0] / value]
        faces = mesh.facets_satisfying(contact, boundaries_only=True)
        held = mesh.facets_satisfying(clamped, boundaries_only=True)
        others = np.setdiff1d(mesh.boundary_facets(), np.concatenate([faces, held]))
        for facets, load in ((faces, pressed), (others, lambda w: [0.0, 0.0])):
            face = FacetBasis(mesh, ElementVector(ElementTriP2()), facets=facets)
            eta = Functional(lambda w: outer(w, load)).elemental(face, a=face.interpolate(field))
            np.add.at(indicator, mesh.f2t[0, facets], eta)
        order = np.argsort(-indicator)
        marked = order[: np.searchsorted(np.cumsum(indicator[order]), 0.5 * indicator.sum()) + 1]
        mesh = mesh.refined(marked)


def main():
    for name in sys.argv[1:] or DOMAINS:
        mesh, tips, clamped, contact = domain(name)
        reach = np.max(np.ptp(tips, axis=1))
        for what, square in (("c_j^2", normal), ("c_tau^2", tangential)):
            graded = [largest(geometric(mesh, tips, reach * w, reach * r), ElementTriP3(), clamped, contact, square)
                      for w, r in ((0.2, 1e-7), (0.1, 1e-10))]
            values = adaptive(mesh, clamped, contact, square, 60000)
            fits = []
            for (a, m), (b, n) in zip(values[-5:], values[-4:]):
                fits.append(b + (b - a) / ((n / m) ** 2 - 1))
            print(f"{name:12} {what:8} cubics {graded[0][0]:.9f} {graded[1][0]:.9f} ({len(graded[1][1])})  "
                  f"quadratics {values[-1][0]:.9f}, extrapolated {fits[-1]:.9f} ({values[-1][1]})", flush=True)


if __name__ == "__main__":
    main()
