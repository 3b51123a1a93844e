"""A solver in this process under the sweep of a scene."""

from __future__ import annotations

import json
import operator
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any

from . import _native
from ._verdict import Verdict

if TYPE_CHECKING:
    from numpy.typing import NDArray


DENSITIES = ("cell_rule", "cell_loads", "facet_rule", "facet_loads")


def scenes() -> dict[str, str]:
    """Names of the scenes with the question that each asks."""
    return dict(_native.scenes())


@dataclass(frozen=True)
class Case:
    """A body on a mesh, a time grid, loads: what is to be solved.

    At t_n, for all admissible v, int sigma_n : eps(v) + int over Gamma3 of (xi_n + lambda_n) v_nu = loads[n] . v; the terms
    of sigma_n are in :attr:`data`.

    Attributes
    ----------
    scene : str
    dimension, n, steps : int
        d, cells per unit length, number N of time steps.
    data : dict
        Sizes, ``elasticity``, ``memory``, ``projection``, ``contact``, and ``as_written``, the scene with all its keys.
    points : ndarray, (vertices, d)
        Of quadratic elements (``data["element"] == "P2"``) the last ``data["midpoints"]`` are midpoints of edges.
    cells : ndarray of int, (cells, d + 1)
        Where there are midpoints corners, then the midpoints of edges 01, 12, 20 and in space 03, 13, 23.
    regions : ndarray of int, (cells,)
        Indices into ``elasticity`` and ``memory``.
    clamped : ndarray of bool, (vertices,)
        Where the displacement is zero.
    facets : ndarray of int, (facets, d)
        Those of the boundary, with midpoints as in ``cells``.
    sides : list of str
        The side of each.
    contact : dict of ndarray
        Gamma3: vertex, normal, weight, gap (inf: none), shift, scale, clamped, table (of ``data["contact"]``, if that is a
        list).
    symmetry : dict of ndarray or None
        Planes of symmetry: vertex, normal; u . normal = 0 there.
    times : ndarray, (N + 1,)
    kernels : ndarray or None
        (terms, N + 1), b_i(t_n), on a uniform grid; else (terms, N + 1, N + 1), b_i(t_n - t_j). Without t^-a where
        ``data["singular"]`` has a > 0.
    loads : ndarray, (N + 1, vertices, d)
        The load functional on each hat function.
    gap : ndarray or None
        (N + 1, rows of Gamma3), where the gap depends on t; ``contact`` has that of t = 0.
    friction : ndarray or None
        (N + 1, rows of Gamma3), the factor of the bound of friction.
    cell_rule, facet_rule : ndarray or None
        (points, barycentric coordinates and the weight), where loads are functions: ``loads="density"``.
    cell_loads, facet_loads : ndarray or None
        (N + 1, cells or facets, points, d), f0 and f2 at the points of the rules.
    """

    scene: str
    dimension: int
    n: int
    steps: int
    data: dict[str, Any]
    points: NDArray[Any]
    cells: NDArray[Any]
    regions: NDArray[Any]
    clamped: NDArray[Any]
    facets: NDArray[Any]
    sides: list[str]
    contact: dict[str, NDArray[Any]]
    times: NDArray[Any]
    kernels: NDArray[Any] | None
    loads: NDArray[Any]
    gap: NDArray[Any] | None = None
    friction: NDArray[Any] | None = None
    symmetry: dict[str, NDArray[Any]] | None = None
    cell_rule: NDArray[Any] | None = None
    cell_loads: NDArray[Any] | None = None
    facet_rule: NDArray[Any] | None = None
    facet_loads: NDArray[Any] | None = None


def verify(
    scene: str,
    solve: Callable[[Case], Any],
    *,
    n: Sequence[int] | None = None,
    steps: Sequence[int] | None = None,
    pressure: bool = False,
    orders_only: bool = False,
    loads: str = "assembled",
    out: str | PathLike[str] | None = None,
) -> list[Verdict]:
    """Put a solver under the sweep of a scene: errors, orders and constants are judged as by ``sweep verify``.

    Parameters
    ----------
    scene : str
        A name among :func:`scenes`; one with an exact solution.
    solve : callable
        Gets a :class:`Case`, gives the displacements of all levels, (N + 1, vertices, d); with ``pressure`` a pair of
        them and xi + lambda, (N + 1, rows of Gamma3).
    n, steps : sequence of int, optional
        Cells per unit length and numbers of time steps in place of the scene's.
    pressure : bool
        The solver gives pressures: they are judged too, and a warning says where no claim of the scene needs them.
    orders_only : bool
        Judge orders and not their constants: for other elements or time rules.
    loads : str
        "density": f0 and f2 at quadrature points are given as well, for solvers that assemble them.
    out : path, optional
        A directory for ``cases.csv``.

    Returns
    -------
    list of Verdict
        One for each prediction of the scene.

    Raises
    ------
    ValueError
        No such scene, one without an exact solution, an array of another shape or with numbers that are not finite.
    Exception
        What ``solve`` raises, as it was raised.
    """
    __tracebackhide__ = True
    import numpy

    if loads not in ("assembled", "density"):
        raise ValueError(f'loads={loads!r}: "assembled" or "density"')

    def answer(raw: dict[str, Any]) -> Any:
        __tracebackhide__ = True
        case = _case(raw, numpy)
        found = solve(case)
        if not pressure:
            return _array(numpy, found, case.loads.shape, "displacements, (levels N + 1, vertices, components)")
        displacement, xi = found
        rows = (case.steps + 1, len(case.contact["vertex"]))
        return (
            _array(numpy, displacement, case.loads.shape, "displacements, (levels N + 1, vertices, components)"),
            _array(numpy, xi, rows, "pressures, (levels N + 1, rows of contact)"),
        )

    lists = [None if values is None else [operator.index(value) for value in values] for values in (n, steps)]
    document = json.loads(_native.verify(scene, answer, *lists, pressure, orders_only, loads == "density", out))
    rows = document["verdicts"]
    if pressure and not any(row["norm"].startswith("pressure") for row in rows):
        warnings.warn(f"no claim of {scene} needs the pressures: no verdict judges them", stacklevel=2)
    return [_verdict(row, document["failures"]) for row in rows]


def _case(raw: dict[str, Any], numpy: Any) -> Case:
    def array(name: str) -> Any:
        data, shape, kind = raw[name]
        return numpy.frombuffer(data, dtype=kind).reshape(shape)

    data = json.loads(raw["json"])
    weight, gap, shift, scale = array("contact_numbers").T
    contact = {
        "vertex": array("contact_vertices"),
        "normal": array("contact_normals"),
        "weight": weight,
        "gap": gap,
        "shift": shift,
        "scale": scale,
        "clamped": array("contact_clamped").astype(bool),
        "table": array("contact_table"),
    }
    return Case(
        scene=data["scene"],
        dimension=data["dimension"],
        n=data["n"],
        steps=data["steps"],
        data=data,
        points=array("points"),
        cells=array("cells"),
        regions=array("regions"),
        clamped=array("clamped").astype(bool),
        facets=array("facets"),
        sides=[raw["sides"][side] for side in array("facet_sides")],
        contact=contact,
        times=array("times"),
        kernels=array("kernels") if "kernels" in raw else None,
        loads=array("loads"),
        symmetry={"vertex": array("symmetry_vertices"), "normal": array("symmetry_normals")},
        **{name: array(name) for name in ("gap", "friction", *DENSITIES) if name in raw},
    )


def _array(numpy: Any, found: Any, shape: tuple[int, ...], what: str) -> bytes:
    __tracebackhide__ = True

    def masked(part: Any) -> bool:
        # An array of masked arrays has no mask itself.
        return numpy.ma.is_masked(part) or isinstance(part, (list, tuple)) and any(map(masked, part))

    if masked(found):
        raise ValueError(f"numbers are masked: {what}")
    if numpy.iscomplexobj(found):
        raise ValueError(f"complex numbers, whose imaginary parts would be lost: {what}")
    array = numpy.ascontiguousarray(found, dtype=float)
    if array.shape != shape:
        raise ValueError(f"shape {array.shape} where {shape} is wanted: {what}")
    if not numpy.isfinite(array).all():
        at = tuple(int(i) for i in numpy.argwhere(~numpy.isfinite(array))[0])
        raise ValueError(f"{array[at]} at {at}: {what}")
    return array.tobytes()


def _verdict(row: dict[str, Any], failures: list[dict[str, Any]]) -> Verdict:
    variable = row["variable"]
    step = "k" if variable == "k" else "h"
    points = [point for point in row["points_used"] if point.get(step) is not None]
    points.sort(key=lambda point: -point[step])
    interval = row.get("interval")
    runs = [f"n = {case['n']}, N = {case['steps']}" for case in row.get("next", [])]
    failed = [failure["reason"] for failure in failures if failure["scene"] == row["scene"]]
    return Verdict(
        decision=row["verdict"],
        order=row["observed"],
        interval=None if interval is None else (interval[0], interval[1]),
        reason="; ".join([row["reason"], *failed[:1]]),
        next=f"run {' and '.join(runs)} as well" if runs else None,
        h=tuple(point[step] for point in points),
        errors=tuple(point["error"] for point in points),
        predicted=row["predicted"],
        at_least=row.get("at_least", False),
        name=f"{row['scene']} {row['norm']}",
        variable=variable if variable in ("h", "k") else "h",
        details=row,
    )
