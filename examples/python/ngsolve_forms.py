"""Two problems of NGSolve's own tests, on any mesh: errors as functions of the number of cells."""

import ngsolve as ng
import numpy as np
from ngsolve.meshes import Make1DMesh

x, dx = ng.x, ng.dx
faces = dx(element_boundary=True)

WAVE = ng.exp(ng.sin(2 * ng.pi * x))
BUMP = ng.exp(-100 * (x - 0.5) ** 2)


def norm(error, mesh):
    return float(np.sqrt(ng.Integrate(ng.InnerProduct(error, error).real, mesh, order=12)))


def upwind(normal, u):
    return ng.IfPos(normal, u, u.Other())


def central(normal, u):
    return 0.5 * (u + u.Other())


def advected(cells, start=WAVE, *, degree=3, flux=upwind, speed=1.0, stages=4, step=None):
    """A wave once around a circle by discontinuous elements; Runge-Kutta of as many orders as stages."""
    mesh = Make1DMesh(cells, periodic=True)
    space = ng.L2(mesh, order=degree)
    u, v = space.TnT()
    normal = ng.specialcf.normal(1)[0]
    transport = ng.BilinearForm(space, nonassemble=True)
    transport += -speed * u * ng.grad(v)[0] * dx + speed * normal * flux(normal, u) * v * faces
    found = ng.GridFunction(space)
    found.Set(start)
    stage, change = found.vec.CreateVector(), found.vec.CreateVector()
    steps = round(1 / (step or 0.05 / cells))
    for _ in range(steps):
        stage.data = found.vec
        for part in range(stages, 0, -1):
            transport.Apply(stage, change)
            space.SolveM(rho=ng.CF(1), vec=change)
            stage.data = found.vec - 1 / (part * steps) * change
        found.vec.data = stage
    return norm(found - start, mesh)


def hybrid(cells, exact=ng.sin(3 * x) * ng.exp(x) * (1 - x), *, adjoint=-1.0, degree=2):
    """-u'' = f by a hybrid discontinuous method; `adjoint` is the sign of the term that makes the form symmetric."""
    mesh = Make1DMesh(cells)
    space = ng.L2(mesh, order=degree) * ng.FacetFESpace(mesh, order=0, dirichlet=".*")
    (u, trace), (v, test) = space.TnT()
    normal, h = ng.specialcf.normal(1), ng.specialcf.mesh_size
    consistent = ng.grad(u) * normal * (v - test) * -1 + adjoint * ng.grad(v) * normal * (u - trace)
    form = ng.grad(u) * ng.grad(v) * dx + (consistent + 4 * degree**2 / h * (u - trace) * (v - test)) * faces
    slope = exact.Diff(x)
    found = ng.GridFunction(space)
    inverse = ng.BilinearForm(form).Assemble().mat.Inverse(space.FreeDofs(), inverse="umfpack")
    found.vec.data = inverse * ng.LinearForm(-slope.Diff(x) * v * dx).Assemble().vec
    u = found.components[0]
    return {"L2": norm(u - exact, mesh), "H1": norm(ng.grad(u)[0] - slope, mesh)}
