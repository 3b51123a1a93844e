"""Meshes by meshio: what any format holds arrives in a file that a scene takes."""

import gronwall
import pytest

meshio = pytest.importorskip("meshio")
numpy = pytest.importorskip("numpy")

POINTS = numpy.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]])
LINES = numpy.array([[0, 1], [1, 2], [2, 3], [3, 0]])
TRIANGLES = numpy.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
NAMES = ["bottom", "right", "top", "left"]
SCENE = """
[scene]
name = "square"
question = "Does the mesh arrive?"
dimension = 2
judge = false
[domain]
shape = "mesh"
file = "mesh.msh"
clamped = {clamped}
rest = "traction"
[time]
horizon = 1.0
[material]
lambda = 1.0
mu_L = 1.0
[exact]
u = ["t*x*(1 - y)", "0"]
interpolated = true
[sweep]
n = [1, 2, 4]
steps = [2]
[[predicts]]
norm = "V_max"
variable = "h"
order = 1.0
why = "the mesh is read"
"""


def cells_of(scene):
    """Cells of the coarsest mesh of a scene."""
    seen = []
    gronwall.verify(str(scene), lambda case: seen.append(len(case.cells)) or 0 * case.loads, n=[1, 2, 4], steps=[2])
    return min(seen)


def taken(tmp_path, clamped):
    scene = tmp_path / "square.toml"
    scene.write_text(SCENE.format(clamped=clamped))
    return cells_of(scene)


@pytest.mark.parametrize("name", ["mesh.msh2.msh", "mesh.inp", "mesh.mesh", "mesh.vtu", "mesh.vtk"])
def test_formats_that_meshio_writes_are_taken_with_their_groups(tmp_path, name):
    cells = [("line", LINES), ("triangle", TRIANGLES)]
    tags = [numpy.array([1, 2, 3, 4]), numpy.array([5, 5, 5, 5])]
    points = numpy.column_stack([POINTS, numpy.zeros(5)])
    if name.endswith("inp"):
        sets = {side: [numpy.array([i]), numpy.array([], int)] for i, side in enumerate(NAMES)}
        mesh = meshio.Mesh(points, cells, cell_sets={**sets, "plate": [numpy.array([], int), numpy.arange(4)]})
        groups, top = [*NAMES, "plate"], ["top"]
    else:
        key = {"msh": "gmsh:physical", "mesh": "medit:ref"}.get(name.rsplit(".")[-1], "markers")
        data = {key: tags} if key != "gmsh:physical" else {key: tags, "gmsh:geometrical": tags}
        mesh = meshio.Mesh(points, cells, cell_data=data)
        groups, top = ["1", "2", "3", "4", "5"], ["3"]
        if key == "gmsh:physical":
            mesh.field_data = {side: numpy.array([i + 1, 1]) for i, side in enumerate(NAMES)} | {"plate": numpy.array([5, 2])}
            groups, top = [*NAMES, "plate"], ["top"]
    options = {"file_format": "gmsh22"} if name.endswith("msh") else {}  # binary, as meshio writes it unless told
    mesh.write(tmp_path / name, **options)
    assert gronwall.convert_mesh(tmp_path / name, tmp_path / "mesh.msh") == groups
    assert taken(tmp_path, str(top).replace("'", '"')) == 4


def test_what_no_scene_takes_is_refused_with_the_reason(tmp_path):
    quads = meshio.Mesh(POINTS[:4], [("quad", numpy.array([[0, 1, 2, 3]]))])
    quads.write(tmp_path / "quads.vtu")
    curved = meshio.Mesh(numpy.vstack([POINTS, POINTS[:1] + 0.1]), [("triangle6", numpy.array([[0, 1, 2, 3, 4, 5]]))])
    curved.write(tmp_path / "curved.vtu")
    for name, said in [("quads.vtu", "quad"), ("curved.vtu", "triangle6")]:
        with pytest.raises(ValueError, match=said):
            gronwall.convert_mesh(tmp_path / name, tmp_path / "mesh.msh")
    assert not (tmp_path / "mesh.msh").exists()
    twice = {"top": [numpy.array([2])], "wall": [numpy.array([1, 2])]}
    meshio.Mesh(POINTS, [("line", LINES)], cell_sets=twice).write(tmp_path / "twice.inp")
    with pytest.raises(ValueError, match="in two groups, `top` and `wall`"):
        gronwall.convert_mesh(tmp_path / "twice.inp", tmp_path / "mesh.msh")
