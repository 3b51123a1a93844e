"""A study of convergence: levels from the cheapest on, until every order is decided."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, NoReturn

from . import _native
from ._fit import demand, fit, number
from ._verdict import Decision, Verdict

#: Levels that an order needs.
FEWEST = 3
#: Levels that are run where none are named: 1/2, 1/4 and so on.
MOST = 12

Solve = Callable[[float], "float | Mapping[str, float]"]


class Results(Mapping[str, Verdict]):
    """The verdicts of a study by the names of its errors.

    Attributes
    ----------
    h : tuple of float
        The levels that were run.
    seconds : tuple of float
        What they took.
    stopped : str
        Why there was no further level.
    """

    def __init__(self, verdicts: Mapping[str, Verdict], h: tuple[float, ...], seconds: tuple[float, ...], stopped: str):
        self._verdicts, self.h, self.seconds, self.stopped = dict(verdicts), h, seconds, stopped

    def __getitem__(self, name: str) -> Verdict:
        return self._verdicts[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._verdicts)

    def __len__(self) -> int:
        return len(self._verdicts)

    def __bool__(self) -> NoReturn:
        """Refuse to be a truth value: results that fail would be true, as any mapping with entries is."""
        raise TypeError(
            f"results are neither true nor false, they are {self.decision!r}: compare .decision == 'pass', or use .demand()"
        )

    @property
    def decision(self) -> Decision:
        """Fail if one verdict fails, else unresolved if one is, else pass."""
        found = {verdict.decision for verdict in self.values()}
        return "fail" if "fail" in found else "pass" if found == {"pass"} else "unresolved"

    def demand(self) -> Results:
        """The results themselves, if all pass.

        Raises
        ------
        AssertionError
            A verdict fails.
        Unresolved
            None fails, and one is unresolved.
        """
        __tracebackhide__ = True
        demand(list(self.values()))
        return self

    def __str__(self) -> str:
        return "\n".join([*map(str, self.values()), f"levels: {self.stopped}"])

    def _repr_html_(self) -> str:
        return "".join(verdict._repr_html_() for verdict in self.values())


class Study:
    """A function with the orders that its errors are to have; a call without arguments runs it."""

    def __init__(
        self,
        solve: Solve,
        order: float | Mapping[str, float],
        budget: float,
        h: Iterable[float] | None,
        fewest: int,
        options: Mapping[str, Any],
    ):
        functools.update_wrapper(self, solve)
        self.solve, self.order, self.budget, self.options = solve, order, budget, dict(options)
        self.fewest = max(fewest, FEWEST)
        self.h = [2.0**-i for i in range(1, MOST + 1)] if h is None else sorted(map(float, h), reverse=True)

    def __call__(self) -> Results:
        """Run levels, the cheapest first, until every order is settled.

        A pass needs four levels and a failure five, of which the last two fail: fewer pass or fail wrong orders too
        often when each of them is judged. No level is begun that would not fit into the budget if its cost grew as that
        of the last two.
        """
        orders = self.order if isinstance(self.order, Mapping) else {"error": self.order}
        run: list[float] = []
        seconds: list[float] = []
        errors: dict[str, list[float]] = {name: [] for name in orders}
        verdicts: dict[str, Verdict] = {}
        stopped = "all were run"
        for h in self.h:
            if h <= (self.options["reference"] or 0.0):
                stopped = f"h = {h:.4g} is no coarser than the reference"
                break
            if len(run) >= FEWEST and seconds[-1] + sum(seconds) + _growth(seconds) > self.budget:
                stopped = f"h = {h:.4g} would leave the budget of {self.budget:g} s"
                break
            begin = time.perf_counter()
            found = self.solve(h)
            seconds.append(time.perf_counter() - begin)
            run.append(h)
            for name, value in _named(found, orders).items():
                errors[name].append(value)
            if len(run) < self.fewest:
                continue
            before = verdicts
            verdicts = {name: fit(run, errors[name], order, name=name, **self.options) for name, order in orders.items()}
            if all(_settled(verdict, before.get(name)) for name, verdict in verdicts.items()):
                stopped = "decided"
                break
        if not verdicts:
            verdicts = {name: fit(run, errors[name], order, name=name, **self.options) for name, order in orders.items()}
        return Results(verdicts, tuple(run), tuple(seconds), stopped)


def study(
    order: float | Mapping[str, float],
    budget: float = 60.0,
    *,
    h: Iterable[float] | None = None,
    fewest: int = FEWEST,
    at_least: bool = False,
    exact: bool = False,
    tolerance: float | None = None,
    floor: float | None = None,
    sigma: float | None = None,
    log: float = 0,
    reference: float | None = None,
) -> Callable[[Solve], Study]:
    """Make a function of h a study of convergence.

    Parameters
    ----------
    order : float or mapping of str to float
        The order of the error that the function gives, or orders by the names of its errors.
    budget : float
        Seconds that all levels may take.
    h : iterable of float, optional
        The levels; 1/2, 1/4, 1/8 and so on without.
    fewest : int
        So many levels are run even if less decide: a small error that stays shows on fine levels.
    at_least, exact, tolerance, floor, sigma, log, reference
        As of :func:`fit`; floor and sigma are those of every level.

    Returns
    -------
    callable
        The decorator.

    Examples
    --------
    >>> @gronwall.study(order={"L2": 3, "H1": 2}, budget=60)
    ... def solve(h):
    ...     return {"L2": h**3, "H1": 2 * h**2}
    >>> solve().decision
    'pass'
    """
    options = {
        "at_least": at_least,
        "exact": exact,
        "tolerance": tolerance,
        "floor": None if floor is None else number(floor, "floor"),
        "sigma": None if sigma is None else number(sigma, "sigma"),
        "log": log,
        "reference": None if reference is None else number(reference, "reference"),
    }
    # What is wrong with them is said before anything is run.
    for one in order.values() if isinstance(order, Mapping) else [order]:
        fit([0.5], [1.0], one, **options)
    return lambda solve: Study(solve, order, budget, h, fewest, options)


def _settled(verdict: Verdict, before: Verdict | None) -> bool:
    """Whether no further level is needed, by the judge's rule for tables that grow."""
    # A level near its floor is none, and confirms nothing.
    earlier = before.decision if before is not None and before.levels < verdict.levels else None
    return _native.settles(verdict.levels, verdict.decision, verdict.probability, earlier)


def _growth(seconds: list[float]) -> float:
    """What the next level takes beyond the last one."""
    return seconds[-1] * max(seconds[-1] / max(seconds[-2], 1e-9) - 1.0, 0.0)


def _named(found: Any, orders: Mapping[str, float]) -> dict[str, float]:
    if not isinstance(found, Mapping):
        if list(orders) != ["error"]:
            raise TypeError(f"the function gives {found!r} where a dictionary of {', '.join(orders)} is wanted")
        found = {"error": found}
    missing = [name for name in orders if name not in found]
    if missing:
        raise KeyError(f"no error is called {', '.join(missing)}; there are {', '.join(found)}")
    return {name: number(found[name], name) for name in orders}
