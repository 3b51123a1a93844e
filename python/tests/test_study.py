"""Studies: levels until every order is decided, within a budget."""

import pytest

import gronwall


def test_the_cheapest_levels_first_and_no_more_than_decide():
    asked = []

    @gronwall.study(order={"L2": 3, "H1": 2})
    def solve(h):
        asked.append(h)
        return {"L2": h**3, "H1": 2 * h**2}

    results = solve()
    assert results.decision == "pass" and results.stopped == "decided"
    assert asked == [0.5, 0.25, 0.125, 0.0625] and set(results) == {"L2", "H1"}
    assert results.demand() is results and solve.__name__ == "solve"


def test_a_failure_is_confirmed_by_one_level_more():
    results = gronwall.study(order=2)(lambda h: h)()
    assert results.decision == "fail" and len(results.h) == 5
    with pytest.raises(AssertionError, match="FAIL"):
        results.demand()


def test_three_levels_that_agree_by_chance_end_nothing():
    # Slopes of 1.25 twice, then of 1: each is a pass where the first three levels are all there is.
    errors = dict(zip([2.0**-i for i in range(1, 8)], [1, 2**-1.25, 2**-2.5, 2**-3.5, 2**-4.5, 2**-5.5, 2**-6.5]))
    three = list(errors)[:3]
    assert gronwall.fit(three, [errors[h] for h in three], order=1.25).decision == "pass"
    assert gronwall.study(order=1.25, h=errors)(errors.__getitem__)().decision != "pass"


def test_a_late_order_gets_more_levels():
    # Order 1 on coarse levels, 2 on fine ones.
    results = gronwall.study(order=2)(lambda h: h**3 / (h + 0.02))()
    assert len(results.h) > 4


def test_the_budget_ends_it_unresolved():
    results = gronwall.study(order=2, budget=1e-9)(lambda h: h**2 * (1 + 5 * h**0.5))()
    assert results.decision != "pass" and "budget" in results.stopped


def test_names_have_to_be_there():
    with pytest.raises(KeyError, match="no error is called H1"):
        gronwall.study(order={"L2": 2, "H1": 1})(lambda h: {"L2": h})()
    with pytest.raises(TypeError, match="dictionary"):
        gronwall.study(order={"L2": 2})(lambda h: h)()


def test_what_passes_beside_what_is_open_is_no_pass():
    # Errors that scatter by a fifth from level to level tell no order.
    scatter = {2.0**-i: 1.2 if i % 2 else 0.8 for i in range(2, 8)}
    results = gronwall.study(order={"sound": 2, "rough": 2}, h=scatter)(
        lambda h: {"sound": h**2, "rough": h**2 * scatter[h]}
    )()
    assert [results[name].decision for name in ("sound", "rough")] == ["pass", "unresolved"]
    assert results.decision == "unresolved"
    with pytest.raises(gronwall.Unresolved, match="rough"):
        results.demand()
    with pytest.raises(TypeError, match="decision == 'pass'"):
        assert results


def test_wrong_options_and_wrong_errors_are_refused():
    def never(h):
        raise AssertionError("nothing is to be run")

    for options in ({"tolerance": -1}, {"floor": float("nan")}, {"sigma": 0}, {"log": float("inf")}):
        with pytest.raises(ValueError, match=r"\d|NaN"):
            gronwall.study(order=2, **options)(never)
    for error in (float("nan"), -1.0, 1j):
        with pytest.raises(ValueError, match=r"no error|complex"):
            gronwall.study(order=2)(lambda h: error)()


def test_no_level_is_run_beyond_the_reference():
    reference = 1 / 32
    run = gronwall.study(0.5, reference=reference, fewest=9)(lambda h: h**0.5 - reference**0.5)()
    assert run.decision == "pass" and run.h == (1 / 2, 1 / 4, 1 / 8, 1 / 16)
    assert "reference" in run.stopped
