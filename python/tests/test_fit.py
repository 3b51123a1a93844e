"""The judge from Python: tables of known orders, what is refused, what is shown."""

import math

import pytest

import gronwall

H = [2.0**-i for i in range(2, 7)]


def table(order, *, floor=0.0, h=H):
    return [3 * step**order + floor for step in h]


@pytest.mark.parametrize("order", [0.5, 1, 2, 3])
def test_an_order_passes_as_itself_and_fails_as_half_more(order):
    sound = gronwall.fit(H, table(order), order)
    assert sound.decision == "pass" and abs(sound.order - order) < 0.01
    assert sound.interval[0] <= order <= sound.interval[1]
    assert gronwall.fit(H, table(order), order + 0.5).decision == "fail"


def test_levels_may_stand_in_any_order():
    mixed = [2, 0, 4, 1, 3]
    errors = table(2)
    again = gronwall.fit([H[i] for i in mixed], [errors[i] for i in mixed], 2)
    assert again == gronwall.fit(H, errors, 2)


def test_a_higher_order_passes_as_a_lower_bound_and_fails_as_exact():
    assert gronwall.fit(H, table(2), 1, at_least=True).decision == "pass"
    assert gronwall.fit(H, table(2), 1, exact=True).decision == "fail"
    assert gronwall.fit(H, table(2), 1).decision == "unresolved"
    assert gronwall.fit(H, table(1), 2, at_least=True).decision == "fail"


def test_a_floor_that_is_told_leaves():
    errors = table(2, floor=table(2)[-1])
    assert gronwall.fit(H, errors, 2).decision != "pass"
    sound = gronwall.fit([*H, H[-1] / 2], [*table(2), 1e-3], 2, floor=[0, 0, 0, 0, 0, 1e-3])
    assert sound.decision == "pass"


def test_two_levels_are_unresolved_and_name_the_next():
    verdict = gronwall.fit(H[:2], table(2)[:2], 2)
    assert verdict.decision == "unresolved" and verdict.order is None
    assert verdict.next == "run h = 0.0625 as well"
    assert "no order" in str(verdict)


def test_without_an_order_there_is_no_verdict():
    verdict = gronwall.fit(H, table(2))
    assert verdict.decision is None and abs(verdict.order - 2) < 0.01


@pytest.mark.parametrize(
    ("h", "errors", "options"),
    [
        (H, [1, 2], {}),
        (H, [math.nan, *table(2)[1:]], {}),
        (H, [0.0, *table(2)[1:]], {}),
        ([0.5, 0.5, 0.25], [1, 1, 1], {}),
        (H, table(2), {"floor": [0.0]}),
        (H, table(2), {"tolerance": -1}),
        (H, table(2), {"at_least": True, "exact": True}),
    ],
)
def test_what_is_no_table_is_refused(h, errors, options):
    with pytest.raises(ValueError, match=r"\d|not both"):
        gronwall.fit(h, errors, 2, **options)


def test_assert_order_shows_the_table():
    assert gronwall.assert_order(H, table(2), 2).decision == "pass"
    with pytest.raises(AssertionError, match="FAIL") as caught:
        gronwall.assert_order(H, table(1), 2)
    assert not isinstance(caught.value, gronwall.Unresolved)
    assert all(f"{error:.3e}" in str(caught.value) for error in table(1))
    with pytest.raises(gronwall.Unresolved, match="UNRESOLVED"):
        gronwall.assert_order(H[:2], table(2)[:2], 2)


def test_views_of_a_verdict():
    verdict = gronwall.fit(H, table(2), 2, name="<L2>")
    page = verdict._repr_html_()
    assert "PASS" in page and "&lt;L2&gt;" in page and page.count("<tr>") == 1 + len(H)
    latex = verdict.to_latex()
    assert latex.count(r"\\") == 2 + len(H) and r"1.875 \cdot 10^{-1}" in latex
    frame = pytest.importorskip("pandas") and verdict.frame()
    assert list(frame.columns) == ["h", "error", "order"] and len(frame) == len(H)


def test_a_plot_has_the_errors_and_the_predicted_slope():
    pytest.importorskip("matplotlib").use("Agg")
    ax = gronwall.fit(H, table(2), 2).plot()
    data, line = ax.get_lines()
    assert list(data.get_ydata()) == table(2)
    x, y = line.get_xdata(), line.get_ydata()
    assert abs(math.log(y[0] / y[-1]) / math.log(x[0] / x[-1]) - 2) < 1e-12
    assert all(below < error for below, error in zip(y, table(2)))
