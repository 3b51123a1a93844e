"""Files for viewers, read by another program than the one that wrote them."""

import json
import subprocess
import sys

import meshio
import numpy
import pytest


@pytest.mark.parametrize(
    ("scene", "n", "shape"),
    [("pure-mild", 4, "triangle"), ("punch-box", 2, "tetra"), ("quadratic-elastic", 4, "triangle6")],
)
def test_meshio_reads_what_solve_computed(tmp_path, scene, n, shape):
    command = [sys.executable, "-m", "gronwall", "solve", scene, "--n", str(n), "--steps", "2", "--vtu", str(tmp_path), "--json"]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    answer = json.loads(run.stdout)
    mesh = meshio.read(tmp_path / f"{scene}_0002.vtu")
    assert [block.type for block in mesh.cells] == [shape]
    u = mesh.point_data["displacement"]
    assert u.shape == mesh.points.shape and u[:, 1].min() == answer["min_uy"]
    # Corners alone: the volume of a cell, of one orientation, and of all together that of a unit square or cube.
    d = 3 if shape == "tetra" else 2
    corners = mesh.points[mesh.cells[0].data[:, : d + 1], :d]
    volumes = numpy.linalg.det(corners[:, 1:] - corners[:, :1]) / (1, 2, 6)[d - 1]
    assert volumes.min() > 0 and abs(volumes.sum() - 1) < 1e-12
    assert len(mesh.cell_data["stress"][0]) == len(volumes)
