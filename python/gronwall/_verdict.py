"""What is said of one table of errors."""

from __future__ import annotations

import html
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, NoReturn

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

Decision = Literal["pass", "fail", "unresolved"]

_COLOURS = {"pass": "#2b8a3e", "fail": "#d9363e", "unresolved": "#a87000", None: "#787f87"}


@dataclass(frozen=True)
class Verdict:
    """A table of errors, its order, and what that says of a predicted order.

    Attributes
    ----------
    decision : {"pass", "fail", "unresolved"} or None
        None where no order is predicted.
    order : float or None
        Median of the order p in error = C h^p; None where the table has no order.
    interval : tuple of float or None
        95 % interval of the order.
    reason : str
        Why, in one sentence.
    next : str or None
        The cheapest run that would help an unresolved verdict.
    h, errors : tuple of float
        The table, from the coarsest level to the finest.
    predicted : float or None
        The order that it was judged by.
    at_least : bool
        The prediction is a lower bound.
    left_out : int
        Coarse levels that the order does not rest on.
    levels : int
        Levels that served: those near their floor do not.
    probability : float or None
        That the order is within the tolerance of the prediction, or of a lower bound not below.
    name : str
        What the errors are of: a norm, a test.
    variable : str
        What is refined: "h", "k", "joint" or "path".
    """

    decision: Decision | None
    order: float | None
    interval: tuple[float, float] | None
    reason: str
    next: str | None
    h: tuple[float, ...]
    errors: tuple[float, ...]
    predicted: float | None = None
    at_least: bool = False
    left_out: int = 0
    levels: int = 0
    probability: float | None = None
    name: str = ""
    variable: str = "h"
    details: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def __bool__(self) -> NoReturn:
        """Refuse to be a truth value: a verdict that fails would be true, as any object is."""
        raise TypeError(
            f"a verdict is neither true nor false, it is {self.decision!r}: "
            "compare .decision == 'pass', or use gronwall.assert_order"
        )

    @property
    def slopes(self) -> list[float]:
        """Orders between neighbouring levels, from coarse to fine."""
        pairs = zip(self.h, self.errors, self.h[1:], self.errors[1:])
        return [_slope(*pair) for pair in pairs]

    def __str__(self) -> str:
        """The answer, then the table."""
        return f"{self.line()}\n{self.table()}"

    def line(self) -> str:
        """The answer in one line."""
        name = f"{self.name}: " if self.name else ""
        decision = f"{self.decision.upper()}, " if self.decision else ""
        claim = "" if self.predicted is None else f", predicted {self._claim()}"
        reason = f": {self.reason}" if self.reason else ""
        then = f"; {self.next}" if self.next else ""
        return f"{name}{decision}{self._order()}{claim}{reason}{then}"

    def table(self) -> str:
        """Steps, errors and the orders between them, as text."""
        rows = [f"  {self.variable:>10}  {'error':>10}  order"]
        for step, error, slope in self._rows():
            rows.append(f"  {step:>10.4g}  {error:>10.3e}  {'' if slope is None else f'{slope:5.2f}'}")
        return "\n".join(rows)

    def frame(self) -> pandas.DataFrame:
        """The table as a pandas data frame with the columns h (or k), error and order."""
        import pandas

        return pandas.DataFrame(self._rows(), columns=[self.variable, "error", "order"])

    def to_latex(self) -> str:
        r"""The table as a LaTeX tabular, as ``sweep fit --latex`` prints it, with the order below it.

        Returns
        -------
        str
            Rules are those of ``booktabs``.
        """
        lines = [r"\begin{tabular}{rrr}", r"\toprule", rf"${self.variable}$ & error & EOC \\", r"\midrule"]
        for step, error, slope in self._rows():
            order = "--" if slope is None else f"{slope:.2f}"
            lines.append(rf"{step:.4g} & ${_scientific(error)}$ & {order} \\")
        if self.order is not None and self.interval is not None:
            low, high = self.interval
            fitted = rf"${self.order:.2f}$ in $[{low:.2f}, {high:.2f}]$"
            lines += [r"\midrule", rf"order & \multicolumn{{2}}{{r}}{{{fitted}}} \\"]
        return "\n".join([*lines, r"\bottomrule", r"\end{tabular}"])

    def plot(self, ax: Axes | None = None) -> Axes:
        """Errors over steps on logarithmic axes, beside the predicted order.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; a new figure without.

        Returns
        -------
        matplotlib.axes.Axes
        """
        if ax is None:
            import matplotlib.pyplot

            ax = matplotlib.pyplot.figure(layout="constrained").gca()
        ax.loglog(self.h, self.errors, "o-", color=_COLOURS[self.decision], label=self._order())
        order = self.order if self.predicted is None else self.predicted
        if order is not None:
            # Below the data, so that slopes are compared and not levels.
            scale = 0.6 * min(error / step**order for step, error in zip(self.h, self.errors))
            words = "fitted" if self.predicted is None else "predicted"
            line = [scale * step**order for step in self.h]
            ax.loglog(self.h, line, "--", color="#57606a", label=f"{words} {order:.3g}")
        # Each level is named, or every second one of many; names of decades would run into each other.
        named = self.h[:: 1 + len(self.h) // 7]
        ax.set_xticks(named, [f"{step:.3g}" for step in named])
        ax.tick_params(axis="x", which="minor", labelbottom=False)
        ax.set_xlabel(self.variable)
        ax.set_ylabel("error")
        ax.set_title(": ".join(part for part in (self.name, self.decision) if part))
        ax.legend()
        return ax

    def _repr_html_(self) -> str:
        def row(step: float, error: float, slope: float | None) -> str:
            order = "" if slope is None else f"{slope:.2f}"
            return f"<tr><td>{step:.4g}</td><td>{error:.3e}</td><td>{order}</td></tr>"

        colour, name = _COLOURS[self.decision], html.escape(self.name)
        rows = "".join(row(*cells) for cells in self._rows())
        claim = "" if self.predicted is None else f", predicted {self._claim()}"
        head = f"<b style='color:{colour}'>{(self.decision or 'fitted').upper()}</b>"
        then = f"<br><i>{html.escape(self.next)}</i>" if self.next else ""
        return (
            f"<div>{f'<b>{name}</b>: ' if name else ''}{head} {html.escape(self._order())}{claim}"
            f"<br>{html.escape(self.reason)}{then}"
            f"<table><thead><tr><th>{self.variable}</th><th>error</th><th>order</th></tr></thead>"
            f"<tbody>{rows}</tbody></table></div>"
        )

    def _order(self) -> str:
        if self.order is None or self.interval is None:
            return "no order"
        low, high = self.interval
        return f"order {self.order:.2f} [{low:.2f}, {high:.2f}]"

    def _claim(self) -> str:
        return f"{'at least ' if self.at_least else ''}{self.predicted:g}"

    def _rows(self) -> list[tuple[float, float, float | None]]:
        return list(zip(self.h, self.errors, [None, *self.slopes]))


def _slope(step: float, error: float, finer: float, less: float) -> float:
    if not (error > 0 and less > 0 and step != finer):
        return math.nan
    return math.log(error / less) / math.log(step / finer)


def _scientific(value: float) -> str:
    digits, _, power = f"{value:.3e}".partition("e")
    return rf"{digits} \cdot 10^{{{int(power)}}}"
