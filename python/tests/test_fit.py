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
    assert verdict.next == "run h = 0.0625"
    assert "no order" in str(verdict)


def test_without_an_order_there_is_no_verdict():
    verdict = gronwall.fit(H, table(2))
    assert verdict.decision is None and abs(verdict.order - 2) < 0.01


@pytest.mark.parametrize(
    ("h", "errors", "options"),
    [
        (H, [1, 2], {}),
        (H, [math.nan, *table(2)[1:]], {}),
        (H, [-1.0, *table(2)[1:]], {}),
        ([0.0, *H[1:]], table(2), {}),
        ([0.5, 0.5, 0.25], [1, 1, 1], {}),
        (H, table(2), {"floor": [0.0]}),
        *[(H, table(2), {"floor": floor}) for floor in (math.nan, math.inf, -1)],
        *[(H, table(2), {"sigma": sigma}) for sigma in (math.nan, math.inf, 0, -1, 1e308)],
        *[(H, table(2), {"log": log}) for log in (math.nan, math.inf, 1e308)],
        (H, table(2), {"tolerance": math.nan}),
        (H, [complex(error, 1) for error in table(2)], {}),
        (H, table(2), {"floor": 1e-9j}),
        (H, table(2), {"tolerance": -1}),
        (H, table(2), {"at_least": True, "exact": True}),
    ],
)
def test_what_is_no_table_is_refused(h, errors, options):
    with pytest.raises(ValueError, match=r"\d|not both|NaN"):
        gronwall.fit(h, errors, 2, **options)
    # Also where nothing is claimed.
    with pytest.raises(ValueError, match=r"\d|not both|NaN"):
        gronwall.fit(h, errors, **options)


def test_arrays_lose_neither_imaginary_parts_nor_masks():
    numpy = pytest.importorskip("numpy")
    assert gronwall.fit(numpy.array(H), numpy.array(table(2)), 2, floor=numpy.float64(0)).decision == "pass"
    for errors in (numpy.array(table(2)) + 1j, list(numpy.array(table(2)) + 0j)):
        with pytest.raises(ValueError, match=r"errors\[0\].*complex"):
            gronwall.fit(H, errors, 2)
    masked = numpy.ma.masked_array(table(2), [0, 0, 0, 0, 1])
    with pytest.raises(ValueError, match=r"errors\[4\].*masked"):
        gronwall.fit(H, masked, 2)
    with pytest.raises(ValueError, match=r"floor\[4\].*masked"):
        gronwall.fit(H, table(2), 2, floor=masked)
    unmasked = numpy.ma.masked_array(table(2), [0] * 5)
    assert gronwall.fit(H, unmasked, 2).decision == "pass"


@pytest.mark.parametrize("floor", [None, 1e-12])
def test_an_error_of_exactly_zero_confirms_nothing_and_is_said(floor):
    for zeros in (1, 2):
        errors = [*table(2)[:-zeros], *[0.0] * zeros]
        verdict = gronwall.fit(H, errors, 2, floor=floor)
        assert verdict.decision == "unresolved" and "run it again" in verdict.reason and verdict.next is None
        assert gronwall.fit(H, errors, 2, at_least=True, floor=floor).decision == "unresolved"
        assert gronwall.fit(H, [*table(1)[:-zeros], *[0.0] * zeros], 2, floor=floor).decision == "fail"
    # Of three levels two are no table; below a floor that the others come down to, a zero is one.
    two = gronwall.fit(H[:3], [1, 0.25, 0.0], 2)
    assert two.decision == "unresolved" and "1 error exactly 0" in two.reason
    near = [100 * step**2 for step in H[:-1]]
    assert gronwall.fit(H, [*near, 0.0], 2, floor=6e-3).decision == "pass"


def test_floors_and_sigmas_go_with_their_steps():
    order = [4, 1, 0, 3, 2]
    # Only the coarsest error is below its floor, and only the finest one is known to the digit.
    floors, sigmas = [1.0, 0.0, 0.0, 0.0, 0.0], [0.3, 0.2, 0.1, 0.05, 0.01]
    shuffled = lambda values: [values[i] for i in order]
    for options in ({"floor": floors}, {"sigma": sigmas}):
        sorted_ = gronwall.fit(H, table(2), 2, **options)
        mixed = {name: shuffled(values) for name, values in options.items()}
        assert gronwall.fit(shuffled(H), shuffled(table(2)), 2, **mixed) == sorted_
        # Left where they stood they would say something else.
        assert gronwall.fit(shuffled(H), shuffled(table(2)), 2, **options) != sorted_
    assert gronwall.fit(H, table(2), 2, floor=floors).levels == 4


def test_a_verdict_is_neither_true_nor_false():
    for verdict in (gronwall.fit(H, table(1), 2), gronwall.fit(H, table(2), 2), gronwall.fit(H, table(2))):
        with pytest.raises(TypeError, match=r"decision == 'pass'.*assert_order"):
            assert verdict


def test_an_option_that_is_none_is_a_type_error():
    for function in (gronwall.fit, gronwall.assert_order):
        with pytest.raises(TypeError, match="tolerence"):
            function(H, table(2), 2, tolerence=3)
    with pytest.raises(TypeError, match="tolerence"):
        gronwall.study(order=2, tolerence=3)


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
    assert latex.splitlines()[:4] == [r"\begin{tabular}{rrr}", r"\toprule", r"$h$ & error & EOC \\", r"\midrule"]
    assert latex.splitlines()[-3].startswith(r"order & \multicolumn{2}{r}{$2.00$ in $[1.")
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
