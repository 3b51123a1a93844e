"""Displacements from the VTU files of a solver."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Of the largest coordinate: numbers with six digits are off by 5e-6 of it.
NEAR = 1e-5


def read_vtu(points: NDArray[Any], files: Sequence[str | PathLike[str]]) -> NDArray[Any]:
    """Displacements of all levels from a ``.vtu`` file for each, by meshio.

    Parameters
    ----------
    points : ndarray, (vertices, d)
        Those of the case: ``Case.points``, or the coordinates of ``vertices.csv``.
    files : sequence of path
        One for each level from t_0 on. Each has every vertex once, in any order, found by its coordinates at rest, to 1e-5 of
        the largest, and the point data ``displacement`` or ``u`` in double precision.

    Returns
    -------
    ndarray, (levels, vertices, d)
        What ``displacement.npy`` holds, and what a solver gives to :func:`verify`.

    Raises
    ------
    ValueError
        A file that is not one of these, with what is wrong.
    """
    import meshio
    import numpy

    points = numpy.asarray(points, dtype=float)
    vertices, d = points.shape
    near = NEAR * abs(points).max()
    # Vertices in boxes of size 2 near: a point is near those of its own box and of those beside it.
    shifts = numpy.stack(numpy.meshgrid(*[(-1, 0, 1)] * d), axis=-1).reshape(-1, d)
    boxes: dict[tuple[int, ...], list[int]] = {}
    for vertex, box in enumerate(numpy.floor(points / (2 * near)).astype(int)):
        boxes.setdefault(tuple(box), []).append(vertex)

    def vertex_of(file: Any, number: int, at: Any) -> int:
        box = numpy.floor(at / (2 * near)).astype(int)
        found = [vertex for shift in shifts for vertex in boxes.get(tuple(box + shift), ())]
        distances = [abs(points[vertex] - at).max() for vertex in found]
        if not found or min(distances) > near:
            raise ValueError(f"{file}: point {number} at {at} is no vertex of the mesh: points are those at rest")
        return found[int(numpy.argmin(distances))]

    levels = numpy.empty((len(files), vertices, d))
    for level, file in zip(levels, files):
        mesh = meshio.read(file)
        known = [name for name in ("displacement", "u") if name in mesh.point_data]
        if not known:
            raise ValueError(f"{file}: no point data `displacement` or `u`; there are: {', '.join(mesh.point_data)}")
        values = mesh.point_data[known[0]]
        if values.dtype != numpy.float64:
            raise ValueError(f"{file}: `{known[0]}` is of type {values.dtype}: write Float64")
        if values.ndim != 2 or values.shape[1] not in (d, 3) or values[:, d:].any():
            raise ValueError(f"{file}: `{known[0]}` has shape {values.shape}, where {d} components are wanted")
        order = [vertex_of(file, i, at) for i, at in enumerate(mesh.points[:, :d])]
        if sorted(order) != list(range(vertices)):
            raise ValueError(
                f"{file}: {len(order)} points, {len(set(order))} of them apart, where the mesh has {vertices} vertices: write each "
                "once; interpolate other elements to the continuous one of the case first"
            )
        level[order] = values[:, :d]
    return levels
