"""Meshes of any format that meshio reads, as files of gmsh that a scene takes."""

from __future__ import annotations

from os import PathLike
from typing import Any

# Cell blocks by dimension, and their types in files of gmsh.
SIMPLICES = {"vertex": (0, 15), "line": (1, 1), "triangle": (2, 2), "tetra": (3, 4)}
# Integer cell data that are groups, where there are neither names nor sets.
TAGS = ("gmsh:physical", "medit:ref", "cell_tags", "boundaries", "markers")


def convert_mesh(source: str | PathLike[str], target: str | PathLike[str]) -> list[str]:
    """Write the mesh of ``source``, of any format that meshio reads, to ``target``, for ``file`` of a scene.

    Groups are those of gmsh with their names, sets of cells (Abaqus, Exodus, ...), or integers beside the cells (Medit, MED,
    XDMF, VTU). ``target`` is a file of gmsh, ASCII, version 2.2.

    Parameters
    ----------
    source, target : path

    Returns
    -------
    list of str
        Names of the groups, those of edges (in space of faces) first: sides of the scene, then regions.

    Raises
    ------
    ValueError
        Cells that are no lines, triangles or tetrahedra, or a cell in two groups.
    """
    import meshio
    import numpy

    mesh = meshio.read(source)
    refused = sorted({block.type for block in mesh.cells} - SIMPLICES.keys())
    if refused:
        raise ValueError(
            f"{source}: cells of type {', '.join(refused)}: a scene has triangles or tetrahedra of order 1, and their edges or "
            'faces; split others, and mesh with order 1 (element = "P2" makes its own midpoints)'
        )
    dimension = max((SIMPLICES[block.type][0] for block in mesh.cells), default=0)
    names: dict[tuple[int, int], str] = {}
    groups = [numpy.zeros(len(block.data), int) for block in mesh.cells]
    tags = next((tag for tag in TAGS if tag in mesh.cell_data), None)
    if tags is not None:
        groups = [numpy.abs(numpy.asarray(numbers)).astype(int).ravel() for numbers in mesh.cell_data[tags]]
        names = {(int(of), int(tag)): name for name, (tag, of) in mesh.field_data.items()}
    else:
        sets = {name: parts for name, parts in mesh.cell_sets.items() if not name.startswith("gmsh:")}
        for tag, (name, parts) in enumerate(sets.items(), 1):
            for block, group, part in zip(mesh.cells, groups, parts):
                if part is None or not len(part):
                    continue
                names[SIMPLICES[block.type][0], tag] = name
                twice = group[part][group[part] != 0]
                if len(twice):
                    first = names[SIMPLICES[block.type][0], int(twice[0])]
                    raise ValueError(f"{source}: a {block.type} is in two groups, `{first}` and `{name}`: leave it in one")
                group[part] = tag

    def rows() -> Any:
        for block, group in zip(mesh.cells, groups):
            of, kind = SIMPLICES[block.type]
            if of in (dimension, dimension - 1):
                for tag, corners in zip(group, block.data):
                    yield f"{kind} 2 {tag} {tag} {' '.join(str(corner + 1) for corner in corners)}"

    points = numpy.zeros((len(mesh.points), 3))
    points[:, : mesh.points.shape[1]] = mesh.points
    known = {key: name for key, name in names.items() if key[0] in (dimension, dimension - 1)}
    elements = list(rows())
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(known))]
    lines += [f'{of} {tag} "{name}"' for (of, tag), name in known.items()]
    lines += ["$EndPhysicalNames", "$Nodes", str(len(points))]
    lines += [f"{i} {' '.join(repr(float(x)) for x in point)}" for i, point in enumerate(points, 1)]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    lines += [f"{i} {row}" for i, row in enumerate(elements, 1)]
    with open(target, "w", encoding="utf-8") as file:
        file.write("\n".join([*lines, "$EndElements", ""]))
    used = {(SIMPLICES[block.type][0], int(tag)) for block, group in zip(mesh.cells, groups) for tag in group if tag}
    used = {key for key in used if key[0] in (dimension, dimension - 1)}
    return [names.get(key, str(key[1])) for key in sorted(used)]
