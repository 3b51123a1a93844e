"""The judge, for any table of errors."""

from __future__ import annotations

import numbers
import sys
from collections.abc import Iterable
from typing import Any

from . import _native
from ._verdict import Verdict


class Unresolved(AssertionError):
    """The table does not tell whether the order holds: neither a pass nor a failure.

    Attributes
    ----------
    verdicts : list of Verdict
    """

    def __init__(self, message: str, verdicts: list[Verdict]):
        super().__init__(message)
        self.verdicts = verdicts


def fit(
    h: Iterable[float],
    errors: Iterable[float],
    order: float | None = None,
    *,
    at_least: bool = False,
    exact: bool = False,
    tolerance: float | None = None,
    floor: float | Iterable[float] | None = None,
    sigma: float | Iterable[float] | None = None,
    log: float = 0,
    reference: float | None = None,
    name: str = "",
) -> Verdict:
    """Order of convergence of a table, and its verdict on a predicted order.

    Parameters
    ----------
    h : iterable of float
        Steps, in any order: mesh sizes or time steps.
    errors : iterable of float
        An error for each step.
    order : float, optional
        The predicted order; without one there is no verdict.
    at_least : bool
        The prediction is a lower bound: a higher order passes.
    exact : bool
        A higher order fails. Without either it is unresolved.
    tolerance : float, optional
        How far the order may lie from the prediction; 0.15, less for orders below 0.375.
    floor : float or iterable of float, optional
        What of the errors is no discretization error: rounding, the tolerance of a solver.
    sigma : float or iterable of float, optional
        Relative standard deviation of the errors, where they are random.
    log : float
        The power M of a factor abs(log h)**M in the prediction.
    reference : float, optional
        The step of the run that the errors are measured against; 0 says that the solution is exact.
    name : str
        What the errors are of, for messages.

    Returns
    -------
    Verdict

    Raises
    ------
    ValueError
        A step that is no positive number; an error or a floor that is negative or no finite number; a complex number, a
        masked one; a deviation that is not positive or above 10; a step twice, lists of different length.

    Notes
    -----
    An error of exactly 0 without a floor is left out and said, and nothing is confirmed then: a pass becomes unresolved.

    The order is inferred from log(error) = c + p log(h) + a next term of unknown size and power + noise; every reading of
    the table is weighed by its evidence, and coarse levels leave that the rest explains itself better without.

    Examples
    --------
    >>> v = gronwall.fit([1/8, 1/16, 1/32], [0.1000, 0.0251, 0.00629], order=2)
    >>> v.decision, round(v.order, 2)
    ('pass', 2.0)
    """
    sizes, values = floats(h, "h"), floats(errors, "errors")
    count = len(sizes)
    if count != len(values):
        raise ValueError(f"{count} steps and {len(values)} errors: each step has one error")
    floors, sigmas = _each(floor, count, "floor", 0.0), _each(sigma, count, "sigma", None)
    order = None if order is None else number(order, "order")
    tolerance = None if tolerance is None else number(tolerance, "tolerance")
    log = number(log, "log")
    reference = None if reference is None else number(reference, "reference")
    by_size = sorted(range(count), key=lambda i: -sizes[i])
    sizes, values, floors, sigmas = ([list_[i] for i in by_size] for list_ in (sizes, values, floors, sigmas))
    found = _native.fit(sizes, values, floors, sigmas, order, at_least, exact, tolerance, log, reference)
    decision = found.get("decision")
    return Verdict(
        decision=decision,
        order=found.get("order"),
        interval=found.get("interval"),
        reason=found.get("reason", ""),
        next=found.get("next"),
        h=tuple(sizes),
        errors=tuple(values),
        predicted=order,
        at_least=at_least,
        left_out=found.get("left_out", 0),
        levels=found.get("levels", 0),
        probability=found.get("probability"),
        name=name,
    )


def assert_order(
    h: Iterable[float],
    errors: Iterable[float],
    order: float,
    *,
    at_least: bool = False,
    exact: bool = False,
    tolerance: float | None = None,
    floor: float | Iterable[float] | None = None,
    sigma: float | Iterable[float] | None = None,
    log: float = 0,
    reference: float | None = None,
    name: str = "",
) -> Verdict:
    """Assert that a table has an order.

    Parameters
    ----------
    h, errors, order, at_least, exact, tolerance, floor, sigma, log, reference, name
        As of :func:`fit`.

    Returns
    -------
    Verdict
        One that passes.

    Raises
    ------
    AssertionError
        The order is another; the message has the table.
    Unresolved
        The table does not tell. It is an AssertionError as well.

    Examples
    --------
    >>> gronwall.assert_order([1/8, 1/16, 1/32], [0.1000, 0.0251, 0.00629], 2).decision
    'pass'
    """
    __tracebackhide__ = True
    verdict = fit(
        h,
        errors,
        order,
        at_least=at_least,
        exact=exact,
        tolerance=tolerance,
        floor=floor,
        sigma=sigma,
        log=log,
        reference=reference,
        name=name,
    )
    demand([verdict])
    return verdict


def demand(verdicts: list[Verdict]) -> None:
    """Raise unless all verdicts pass: a failure goes before what is unresolved."""
    __tracebackhide__ = True
    text = "\n".join(str(verdict) for verdict in verdicts if verdict.decision != "pass")
    if any(verdict.decision not in ("pass", "unresolved") for verdict in verdicts):
        raise AssertionError(text)
    if text or not verdicts:
        raise Unresolved(text or "nothing was judged", verdicts)


def number(value: Any, what: str) -> float:
    """A real number that is there: the imaginary part of another, or what lies under a mask, would be lost silently."""
    complex_ = isinstance(value, numbers.Complex) and not isinstance(value, numbers.Real)
    if complex_ or getattr(getattr(value, "dtype", None), "kind", "") == "c":
        raise ValueError(f"{what}: {value} is a complex number: an error is the size of one, abs(...)")
    numpy = sys.modules.get("numpy")
    if numpy is not None and numpy.ma.is_masked(value):
        raise ValueError(f"{what}: a number is masked: leave its level out, or compute it")
    return float(value)


def floats(values: Iterable[float], what: str) -> list[float]:
    return [number(value, f"{what}[{i}]") for i, value in enumerate(values)]


def _each(value: Any, count: int, name: str, none: Any) -> list[Any]:
    if value is None:
        return [none] * count
    try:
        one_by_one = iter(value)
    except TypeError:
        return [number(value, name)] * count
    values = floats(one_by_one, name)
    if len(values) != count:
        raise ValueError(f"{len(values)} values of {name} for {count} steps")
    return values
