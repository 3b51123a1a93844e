"""Linear viscoelasticity by P1 in the plane: NGSolve assembles, factors and solves."""

import json, os, sys
import numpy as np
from netgen.meshing import Element2D, FaceDescriptor, Mesh as Netgen, MeshPoint, Pnt
from ngsolve import BilinearForm, BitArray, Grad, Id, InnerProduct, Mesh, Sym, Trace, VectorH1, dx

os.chdir(sys.argv[1])
case, loads = json.load(open("case.json")), np.load("loads.npy")
table = lambda name: np.loadtxt(f"{name}.csv", delimiter=",", skiprows=1, ndmin=2)
vertices, cells = table("vertices"), table("cells").astype(int)
raw = Netgen(dim=2)
points = [raw.Add(MeshPoint(Pnt(x, y, 0))) for x, y in vertices[:, 1:3]]
for region in range(len(case["elasticity"])):
    raw.Add(FaceDescriptor(bc=region + 1, domin=region + 1, surfnr=region + 1))
    raw.SetMaterial(region + 1, f"region{region}")
for _, *corners, region in cells:
    raw.Add(Element2D(int(region) + 1, [points[i] for i in corners]))
mesh = Mesh(raw)
space = VectorH1(mesh, order=1)  # unknowns: all u_x by vertex, then all u_y
u, v = space.TnT()
free = BitArray(list(np.tile(vertices[:, 3] == 0, 2)))


def stiffness(laws):
    form, strain = BilinearForm(space), Sym(Grad(u))
    for region, law in enumerate(laws):
        stress = 2 * law["mu"] * strain + law["lambda"] * Trace(strain) * Id(2)
        form += InnerProduct(stress, Sym(Grad(v))) * dx(f"region{region}")
    return form.Assemble().mat


A, memory = stiffness(case["elasticity"]), [stiffness(laws) for laws in case["memory"]]
kernels = np.load("kernels.npy") if memory else []
levels, k = len(loads), case["horizon"] / case["steps"]
answer, f, past = np.zeros((levels, space.ndof)), A.CreateColVector(), A.CreateColVector()
for n in range(levels):
    w = np.full(n + 1, k)  # the trapezoidal rule: half at both ends, nothing at t = 0
    w[0], w[n] = w[0] / 2, w[n] / 2 * (n > 0)
    f.FV().NumPy()[:] = loads[n].T.ravel()
    matrix = A.CreateMatrix()
    matrix.AsVector().data = A.AsVector()
    for M, b in zip(memory, kernels):
        matrix.AsVector().data += w[n] * b[0] * M.AsVector()
        past.FV().NumPy()[:] = (w * b[n::-1])[:n] @ answer[:n]
        f.data -= M * past
    if n < 2:  # all later levels have the matrix of the second
        inverse = matrix.Inverse(free, inverse="sparsecholesky")
    answer[n] = (inverse * f).Evaluate().FV().NumPy()
np.save("displacement.npy", answer.reshape(levels, 2, -1).transpose(0, 2, 1))
