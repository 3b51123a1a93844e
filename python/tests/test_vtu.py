"""Files for viewers, read by another program than the one that wrote them, and as answers of a solver."""

import csv
import json
import subprocess
import sys

import gronwall
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


def test_an_answer_as_vtu_is_that_of_the_solver(tmp_path):
    """signorini as solved, out by files in another order of points and back: the errors of the built-in solver."""
    n, steps = 4, 3

    dots = lambda count: [("vertex", numpy.arange(count)[:, None])]

    def solve(case):
        scene = [sys.executable, "-m", "gronwall", "solve", case.scene, "--n", str(case.n), "--steps", str(case.steps)]
        subprocess.run([*scene, "--vtu", str(tmp_path)], check=True, capture_output=True)
        files = [tmp_path / f"{case.scene}_{level:04}.vtu" for level in range(case.steps + 1)]
        for file in files:
            mesh = meshio.read(file)
            order = numpy.random.default_rng(1).permutation(len(mesh.points))
            turned = meshio.Mesh(mesh.points[order], dots(len(order)), {"u": mesh.point_data["displacement"][order]})
            meshio.write(file, turned, binary=False)
        u = gronwall.read_vtu(case.points, files)
        assert u.shape == case.loads.shape
        wrong = meshio.read(files[1])
        for change, said in [
            (lambda m: m.points.__setitem__(0, m.points[1]), "24 of them apart"),
            (lambda m: m.points.__setitem__(0, [7.0, 0.0, 0.0]), "point 0 at .* is no vertex"),
            (lambda m: m.point_data.__setitem__("u", m.point_data["u"].astype("f4")), "write Float64"),
            (lambda m: m.point_data.__setitem__("v", m.point_data.pop("u")), "there are: v"),
        ]:
            other = wrong.copy()
            change(other)
            meshio.write(tmp_path / "wrong.vtu", other)
            with pytest.raises(ValueError, match=said):
                gronwall.read_vtu(case.points, [tmp_path / "wrong.vtu"])
        return u

    gronwall.verify("signorini", solve, n=[n], steps=[steps], out=tmp_path / "out")
    subprocess.run(
        [sys.executable, "-m", "gronwall", "run", "signorini", "--n", str(n), "--steps", str(steps), "--out", str(tmp_path / "own")],
        capture_output=True,
    )
    errors = [
        {row["norm"]: float(row["error"]) for row in csv.DictReader(open(tmp_path / name / "cases.csv")) if row["error"]}
        for name in ("out", "own")
    ]
    # Text has all but the last digits of a displacement of 0.1.
    assert abs(errors[0]["V_max"] / errors[1]["V_max"] - 1) < 1e-9
