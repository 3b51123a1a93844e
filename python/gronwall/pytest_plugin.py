"""pytest: orders of convergence, with a separate outcome where a table does not decide.

``order_study`` judges and keeps for the summary; ``--gronwall-report DIR`` writes what was kept.
"""

from __future__ import annotations

import dataclasses
import html
import json
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import pytest

from ._fit import Unresolved, demand, fit
from ._study import Results, Study, study
from ._verdict import Verdict

#: The name of a kept verdict among the properties of a test: they reach the process that reports.
KEPT = "gronwall"


class OrderStudy:
    """Judges orders of a test, and keeps the verdicts for the summary."""

    def __init__(self, properties: list[tuple[str, object]], test: str):
        self._properties, self._test = properties, test
        self.verdicts: list[Verdict] = []

    def __call__(
        self,
        solve: Any,
        order: float | Mapping[str, float] | None = None,
        *,
        h: Iterable[float] | None = None,
        budget: float = 60.0,
        fewest: int = 3,
        at_least: bool = False,
        exact: bool = False,
        tolerance: float | None = None,
        floor: float | None = None,
        sigma: float | None = None,
        log: float = 0,
        reference: float | None = None,
    ) -> Results:
        """Run a function of h until its orders are decided, and demand them.

        Parameters
        ----------
        solve : callable or Study
            A function of h that gives an error or errors by name, or what :func:`gronwall.study` made of one.
        order, h, budget, fewest, at_least, exact, tolerance, floor, sigma, log, reference
            As of :func:`gronwall.study`; of a Study they are its own.

        Raises
        ------
        AssertionError, Unresolved
            As :func:`gronwall.assert_order`.
        """
        __tracebackhide__ = True
        if not isinstance(solve, Study):
            if order is None:
                raise TypeError("order_study needs the order that the errors are to have")
            solve = study(
                order,
                budget,
                h=h,
                fewest=fewest,
                at_least=at_least,
                exact=exact,
                tolerance=tolerance,
                floor=floor,
                sigma=sigma,
                log=log,
                reference=reference,
            )(solve)
        results = solve()
        self._keep(results.values())
        return results.demand()

    def check(
        self,
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
        """Judge a table that is there, as :func:`gronwall.assert_order`."""
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
        self._keep([verdict])
        demand([verdict])
        return verdict

    def verify(
        self,
        scene: str,
        solve: Any,
        *,
        n: Sequence[int] | None = None,
        steps: Sequence[int] | None = None,
        pressure: bool = False,
        orders_only: bool = False,
        out: str | PathLike[str] | None = None,
    ) -> list[Verdict]:
        """Put a solver under a scene, as :func:`gronwall.verify`, and demand that all verdicts pass."""
        __tracebackhide__ = True
        from ._verify import verify

        verdicts = verify(scene, solve, n=n, steps=steps, pressure=pressure, orders_only=orders_only, out=out)
        self._keep(verdicts)
        demand(verdicts)
        return verdicts

    def _keep(self, verdicts: Iterable[Verdict]) -> None:
        for verdict in verdicts:
            self.verdicts.append(verdict)
            self._properties.append((KEPT, json.dumps(_plain(verdict, self._test))))


@pytest.fixture
def order_study(request: pytest.FixtureRequest) -> OrderStudy:
    """Judges orders of convergence: ``order_study(solve, order=2)`` or ``order_study.check(h, errors, 2)``."""
    return OrderStudy(request.node.user_properties, request.node.nodeid)


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("gronwall", "orders of convergence")
    group.addoption("--gronwall-report", metavar="DIR", help="write verdicts as JSON, HTML and LaTeX into DIR")
    group.addoption(
        "--gronwall-unresolved",
        choices=["fail", "warn"],
        default="fail",
        help="what becomes of a test whose table does not tell the order: fail (the default), or a line in the summary",
    )


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Any:
    outcome = yield
    if call.excinfo is not None and call.excinfo.errisinstance(Unresolved):
        report = outcome.get_result()
        report.gronwall_unresolved = True
        if item.config.getoption("--gronwall-unresolved") == "warn":
            report.outcome = "passed"


def pytest_report_teststatus(report: pytest.TestReport) -> Any:
    if getattr(report, "gronwall_unresolved", False):
        return "unresolved", "U", ("UNRESOLVED", {"yellow": True})
    return None


@pytest.hookimpl(hookwrapper=True, tryfirst=True)
def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> Any:
    _write_orders(terminalreporter, config)
    yield
    # pytest ends with the tests that failed; these fail the run too.
    unresolved = [report for report in terminalreporter.stats.get("unresolved", []) if report.failed]
    if unresolved and not terminalreporter.stats.get("failed"):
        terminalreporter.section("short test summary info")
    for report in unresolved:
        terminalreporter.write_line(f"UNRESOLVED {report.nodeid} - {_reason(report)}")


def _reason(report: pytest.TestReport) -> str:
    crash = getattr(report.longrepr, "reprcrash", None)
    first = (crash.message if crash else str(report.longrepr)).strip().splitlines()[0]
    return first.removeprefix("gronwall._fit.Unresolved: ").removeprefix("UNRESOLVED, ")


def _write_orders(terminalreporter: Any, config: pytest.Config) -> None:
    reports = [report for kind in terminalreporter.stats.values() for report in kind if isinstance(report, pytest.TestReport)]
    kept = []
    for report in reports:
        if report.when == "call":
            kept += [json.loads(str(text)) for name, text in report.user_properties if name == KEPT]
    unresolved = terminalreporter.stats.get("unresolved", [])
    if kept or unresolved:
        terminalreporter.section("orders of convergence")
    for row in kept:
        colour = {"pass": "green", "fail": "red"}.get(row["decision"], "yellow")
        terminalreporter.write_line(f"{row['decision'] or 'fitted':<10}  {row['test']}  {_verdict(row).line()}", **{colour: True})
    judged = {row["test"] for row in kept}
    for report in unresolved:
        if report.nodeid not in judged:
            last = str(report.longrepr).strip().splitlines()[-1]
            terminalreporter.write_line(f"unresolved  {report.nodeid}  {last}", yellow=True)
    directory = config.getoption("--gronwall-report")
    if directory:
        write_report(Path(directory), kept)
        terminalreporter.write_line(f"report: {Path(directory) / 'index.html'}")


def write_report(directory: Path, kept: list[dict[str, Any]]) -> None:
    """Verdicts as ``verdicts.json``, ``index.html`` and ``tables.tex``."""
    directory.mkdir(parents=True, exist_ok=True)
    (directory / "verdicts.json").write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    verdicts = [(row["test"], _verdict(row)) for row in kept]
    parts = "".join(f"<h2>{html.escape(test)}</h2>{verdict._repr_html_()}" for test, verdict in verdicts)
    page = f"<!doctype html><meta charset='utf-8'><title>Orders of convergence</title>{_STYLE}<h1>Orders of convergence</h1>{parts}"
    (directory / "index.html").write_text(page, encoding="utf-8")
    tables = "\n\n".join(f"% {test} {verdict.name}\n{verdict.to_latex()}" for test, verdict in verdicts)
    (directory / "tables.tex").write_text(tables + "\n", encoding="utf-8")


_STYLE = (
    "<style>body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:50em}h2{font-size:1em;margin-top:2em}"
    "table{border-collapse:collapse;margin-top:.5em}td,th{text-align:right;padding:.1em 1em}th{border-bottom:1px solid}</style>"
)


def _plain(verdict: Verdict, test: str) -> dict[str, Any]:
    plain = {one.name: getattr(verdict, one.name) for one in dataclasses.fields(verdict) if one.name != "details"}
    return {"test": test, **plain}


def _verdict(row: dict[str, Any]) -> Verdict:
    return Verdict(**{name: value for name, value in row.items() if name != "test"})
