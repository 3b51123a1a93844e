"""Tables of errors as people have them."""

from __future__ import annotations

import csv
import io
import math
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _native
from ._fit import fit, number
from ._verdict import Verdict

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Table:
    """The errors of one norm, or of one value of a parameter, level by level.

    Attributes
    ----------
    name : str
        The norm, after the value of the parameter where the text has several.
    h, k : tuple of float
        The steps; NaN where the table has no such column.
    errors : tuple of float
    gaps : str or None
        Rows that are no levels, with their lines: a missing or broken error. The verdict is then "fail".
    said : str
        What was read, and what was left out.
    """

    name: str
    h: tuple[float, ...]
    k: tuple[float, ...]
    errors: tuple[float, ...]
    floors: tuple[float, ...]
    sigmas: tuple[float | None, ...]
    gaps: str | None
    said: str

    def fit(self, order: float | None = None, **options: Any) -> Verdict:
        """The order in the step that is refined, and the verdict on a predicted order.

        Parameters
        ----------
        order : float, optional
        **options
            Those of :func:`gronwall.fit`.

        Raises
        ------
        ValueError
            Neither step is refined, or both are.
        """
        refined = [step for step in ("h", "k") if len({s for s in getattr(self, step) if not math.isnan(s)}) > 1]
        if len(refined) != 1:
            what = "h and k are both refined: `sweep fit` judges grids" if refined else "no step takes two values"
            raise ValueError(f"{self.name or 'the table'}: {what}")
        variable = refined[0]
        options.setdefault("name", self.name)
        if "floor" not in options and any(self.floors):
            options["floor"] = self.floors
        if "sigma" not in options and all(sigma is not None for sigma in self.sigmas):
            options["sigma"] = self.sigmas
        verdict = fit(getattr(self, variable), self.errors, order, **options)
        changed: dict[str, Any] = {"variable": variable}
        if verdict.next:
            changed["next"] = verdict.next.replace("h =", f"{variable} =")
        if self.gaps and order is not None:
            changed |= {"decision": "fail", "reason": self.gaps, "next": None, "probability": None}
        return Verdict(**{**verdict.__dict__, **changed})

    def frame(self) -> pandas.DataFrame:
        """The levels as a pandas data frame with the columns h, k and error."""
        import pandas

        return pandas.DataFrame({"h": self.h, "k": self.k, "error": self.errors})


def read(
    source: str | os.PathLike[str] | Mapping[str, Iterable[Any]] | Any,
    *,
    dimension: int | None = None,
    ratio: float | None = None,
    in_time: bool = False,
    by: str | Iterable[str] = (),
    runs: bool = False,
    errors: str | Iterable[str] = (),
) -> list[Table]:
    """The tables of a text, by the reader of `sweep fit`.

    Parameters
    ----------
    source : str, path, mapping, or data frame
        A text with a line end, or the path of a file; a dict of columns, a pandas data frame or an xarray dataset.
    dimension : int, optional
        Of the mesh, where its size is a number of cells or unknowns.
    ratio : float, optional
        Each row refines by it, where the table has no sizes.
    in_time : bool
        The sizes by `ratio` are time steps.
    by : str or iterable of str
        A table for each value of these columns.
    runs : bool
        Rows of one level are runs: their mean counts, and their scatter is the noise.
    errors : str or iterable of str
        Columns that are errors, whatever their names.

    Returns
    -------
    list of Table
        Each with ``.fit(order)``; ``.said`` tells what was read.

    Raises
    ------
    ValueError
        No table, or one with two readings; with the line, and what to do. A complex, masked or object column.

    Examples
    --------
    >>> table, = gronwall.read("n error\\n8 0.1000\\n16 0.0251\\n32 0.00629\\n")
    >>> table.fit(2).decision
    'pass'
    """
    by = [by] if isinstance(by, str) else list(by)
    errors = [errors] if isinstance(errors, str) else list(errors)
    said, found = _native.read(_text(source), dimension, ratio, in_time, by, runs, errors)
    tables = []
    for group in found:
        name = " ".join(part for part in (group["scene"], group["norm"]) if part)
        if group["values"]:
            raise ValueError(f"{name or 'value'}: values without an exact one are extrapolated by `sweep fit`")
        columns = [tuple(group[key]) for key in ("h", "k", "errors", "floors", "sigmas")]
        tables.append(Table(name, *columns, group["gaps"], "\n".join(said)))
    return tables


def _text(source: Any) -> str:
    if isinstance(source, str) and "\n" in source:
        return source
    if isinstance(source, (str, os.PathLike)):
        with open(source, encoding="utf-8") as file:
            return file.read()
    if hasattr(source, "to_dataframe"):
        source = source.to_dataframe().reset_index()
    if not hasattr(source, "keys"):
        raise ValueError(f"{type(source).__name__}: a text, a path, a dict of columns or a data frame is read")
    columns = {str(name): _cells(str(name), source[name]) for name in source.keys()}
    lengths = {len(cells) for cells in columns.values()}
    if len(lengths) > 1:
        raise ValueError(f"columns of different length: {', '.join(f'{n} has {len(c)}' for n, c in columns.items())}")
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(columns)
    writer.writerows(zip(*columns.values()))
    return text.getvalue()


def _cells(name: str, column: Iterable[Any]) -> list[str]:
    """Cells that are read back as they were; what has no one number is refused."""

    def cell(i: int, value: Any) -> str:
        if isinstance(value, str):
            return value
        try:
            # A missing value of pandas is no number and no float: it stays missing.
            return "" if type(value).__name__ == "NAType" else repr(number(value, f"{name}[{i}]"))
        except TypeError:
            raise ValueError(f"{name}[{i}]: {type(value).__name__} is no number and no word") from None

    return [cell(i, value) for i, value in enumerate(column)]
