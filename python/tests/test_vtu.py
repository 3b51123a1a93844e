"""Files for viewers, read by another program than the one that wrote them."""

import json
import subprocess
import sys

import meshio
import numpy
import pytest


def last_step(folder, scene, n):
    """What `sweep solve` printed, and the mesh of its last step."""
    command = [sys.executable, "-m", "gronwall", "solve", scene, "--n", str(n), "--steps", "2", "--vtu", str(folder), "--json"]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout), meshio.read(folder / f"{scene}_0002.vtu")


@pytest.mark.parametrize(
    ("scene", "n", "shape"),
    [("pure-mild", 4, "triangle"), ("punch-box", 2, "tetra"), ("quadratic-elastic", 4, "triangle6")],
)
def test_meshio_reads_what_solve_computed(tmp_path, scene, n, shape):
    answer, mesh = last_step(tmp_path, scene, n)
    assert [block.type for block in mesh.cells] == [shape]
    u = mesh.point_data["displacement"]
    assert u.shape == mesh.points.shape and u[:, 1].min() == answer["min_uy"]
    # Corners alone: the volume of a cell, of one orientation, and of all together that of a unit square or cube.
    d = 3 if shape == "tetra" else 2
    corners = mesh.points[mesh.cells[0].data[:, : d + 1], :d]
    volumes = numpy.linalg.det(corners[:, 1:] - corners[:, :1]) / (1, 2, 6)[d - 1]
    assert volumes.min() > 0 and abs(volumes.sum() - 1) < 1e-12
    assert len(mesh.cell_data["stress"][0]) == len(volumes)


@pytest.mark.parametrize(("scene", "n", "d"), [("zone-appears", 4, 2), ("friction-box-falling", 2, 3)])
def test_stress_is_that_of_the_displacement(tmp_path, scene, n, d):
    """Both bodies are elastic, with linear elements and lambda = mu_L = 1: sigma = tr(e) I + 2 e in each cell."""
    _, mesh = last_step(tmp_path, scene, n)
    cells = mesh.cells[0].data
    edges = lambda values: values[cells[:, 1:], :d] - values[cells[:, :1], :d]
    gradient = numpy.linalg.solve(edges(mesh.points), edges(mesh.point_data["displacement"]))
    strain = (gradient + gradient.transpose(0, 2, 1)) / 2
    sigma = numpy.trace(strain, axis1=1, axis2=2)[:, None, None] * numpy.eye(d) + 2 * strain
    found = mesh.cell_data["stress"][0]
    # xx, yy, zz, xy, yz, xz; in the plane the others are zero.
    for column, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]):
        wanted = sigma[:, i, j] if max(i, j) < d else 0.0
        assert abs(found[:, column] - wanted).max() < 1e-12 * abs(sigma).max(), (i, j)
