"""Linear viscoelasticity by P1 in the plane, with or without a rigid obstacle: numpy and scipy alone."""

import json, os, sys
import numpy as np
from scipy.sparse import bmat, csr_matrix
from scipy.sparse.linalg import spsolve

os.chdir(sys.argv[1])
case, loads = json.load(open("case.json")), np.load("loads.npy")
table = lambda name: np.loadtxt(f"{name}.csv", delimiter=",", skiprows=1, ndmin=2)
vertices, cells, contact = table("vertices"), table("cells"), table("contact").reshape(-1, 9)
levels, size, k = len(loads), loads[0].size, case["horizon"] / case["steps"]
kernels = np.load("kernels.npy") if case["memory"] else []
corners, region = cells[:, 1:4].astype(int), cells[:, 4].astype(int)
x, dofs = vertices[corners, 1:3], (2 * corners[:, :, None] + [0, 1]).reshape(-1, 6)
slopes = np.linalg.inv(np.dstack([np.ones((len(x), 3)), x]))[:, 1:]
area = abs(np.linalg.det(x[:, 1:] - x[:, :1])) / 2
B = np.zeros((len(x), 3, 6))  # strains xx, yy, 2 xy of the hat functions
B[:, 0, 0::2] = B[:, 2, 1::2] = slopes[:, 0]
B[:, 1, 1::2] = B[:, 2, 0::2] = slopes[:, 1]
def stiffness(laws):  # isotropic, one law a region
    laws = [np.outer([1, 1, 0], [1, 1, 0]) * law["lambda"] + np.diag([2, 2, 1]) * law["mu"] for law in laws]
    K = np.einsum("c,cia,cij,cjb->cab", area, B, np.array(laws)[region], B)
    return csr_matrix((K.ravel(), (dofs.repeat(6), np.tile(dofs, 6).ravel())), (size, size))
A, memory = stiffness(case["elasticity"]), [stiffness(laws) for laws in case["memory"]]
free, rows = np.flatnonzero((vertices[:, 3] == 0).repeat(2)), len(contact)
at = 2 * contact[:, 1:2].astype(int) + [0, 1]
normal = csr_matrix((contact[:, 2:4].ravel(), (np.arange(rows).repeat(2), at.ravel())), (rows, size))
weight = contact[:, 4]
gap = np.load("gap.npy") if os.path.exists("gap.npy") else np.tile(contact[:, 5], (levels, 1))
u, force, touching = np.zeros((levels, size)), np.zeros((levels, rows)), np.zeros(rows, bool)
for n in range(levels):
    w = np.full(n + 1, k)  # the trapezoidal rule: half at both ends, nothing at t = 0
    w[0], w[n] = w[0] / 2, w[n] / 2 * (n > 0)
    S, f = A.copy(), loads[n].ravel().copy()
    for M, b in zip(memory, kernels):
        S, f = S + w[n] * b[0] * M, f - M @ ((w * b[n::-1])[:n] @ u[:n])
    for _ in range(99):  # until the same vertices touch the obstacle
        N, known = normal[touching][:, free], touching
        found = spsolve(bmat([[S[free][:, free], N.T], [N, None]], "csc"), np.r_[f[free], gap[n, known]])
        u[n, free], force[n], force[n, known] = found[: free.size], 0, found[free.size :]
        touching = np.where(known, force[n] > 0, normal @ u[n] > gap[n])
        if (touching == known).all():
            break
np.save("displacement.npy", u.reshape(loads.shape))
np.save("pressure.npy", force / weight)
