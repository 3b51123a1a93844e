"""The plugin in separate runs: three outcomes, summary, exit status, report."""

import json

import pytest

pytest_plugins = ["pytester"]

TESTS = """
import gronwall

def test_sound(order_study):
    order_study(lambda h: {"L2": h**2}, {"L2": 2})

def test_wrong(order_study):
    order_study(lambda h: {"L2": h}, {"L2": 2})

def test_short(order_study):
    order_study.check([0.5, 0.25], [0.25, 0.0625], 2, name="two levels")

def test_plain():
    gronwall.assert_order([0.5, 0.25], [0.25, 0.0625], 2)

def test_other():
    assert True
"""


def test_three_outcomes(pytester):
    pytester.makepyfile(TESTS)
    run = pytester.runpytest("-p", "no:cacheprovider", "--gronwall-report", "report")
    assert run.ret == pytest.ExitCode.TESTS_FAILED
    assert run.parseoutcomes() == {"passed": 2, "failed": 1, "unresolved": 2}
    run.stdout.fnmatch_lines(
        [
            "*orders of convergence*",
            "pass *test_sound*L2: PASS, order 2.00*",
            "fail *test_wrong*L2: FAIL, order 1.00*",
            "unresolved *test_short*two levels: UNRESOLVED*run h = 0.125*",
            "unresolved *test_plain*",
        ]
    )
    found = json.loads((pytester.path / "report" / "verdicts.json").read_text())
    assert [row["decision"] for row in found] == ["pass", "fail", "unresolved"]
    page = (pytester.path / "report" / "index.html").read_text()
    assert "test_wrong" in page and page.count("<table>") == 3
    assert (pytester.path / "report" / "tables.tex").read_text().count(r"\begin{tabular}") == 3


def test_unresolved_alone_fails_the_run_unless_it_is_only_to_warn(pytester):
    pytester.makepyfile(TESTS)
    for options, status in [((), pytest.ExitCode.TESTS_FAILED), (("--gronwall-unresolved=warn",), pytest.ExitCode.OK)]:
        run = pytester.runpytest("-k", "short", *options)
        assert run.ret == status and run.parseoutcomes()["unresolved"] == 1
        listed = [line for line in run.outlines if line.startswith("UNRESOLVED ") and "test_short" in line]
        assert len(listed) == (status == pytest.ExitCode.TESTS_FAILED), run.outlines


def test_options_have_names(pytester):
    pytester.makepyfile(
        """
        import pytest

        def test_names(order_study):
            table = [0.5, 0.25, 0.125], [0.25, 0.0625, 0.015625]
            for call in (
                lambda: order_study(lambda h: h**2, 2, tolerence=3),
                lambda: order_study.check(*table, 2, tolerence=3),
                lambda: order_study.verify("steady", None, stepps=[1]),
            ):
                with pytest.raises(TypeError, match="tolerence|stepps"):
                    call()
            assert order_study.check(*table, 1, at_least=True).decision == "pass"
            assert order_study(lambda h: h**2, 1, at_least=True, tolerance=0.1).decision == "pass"
        """
    )
    pytester.runpytest().assert_outcomes(passed=1)


def test_a_run_without_orders_has_no_summary(pytester):
    pytester.makepyfile("def test_other():\n    assert True\n")
    assert "orders of convergence" not in pytester.runpytest().stdout.str()


def test_a_solver_under_a_scene_is_told_what_to_look_at_first(pytester):
    pytest.importorskip("numpy")
    pytester.makepyfile(
        """
        def test_silent(order_study):
            order_study.verify("viscoelastic", lambda case: 0 * case.loads, n=[4, 8, 16], steps=[4])
        """
    )
    run = pytester.runpytest()
    run.assert_outcomes(failed=1)
    run.stdout.fnmatch_lines(["fail *viscoelastic V_max: FAIL*look at the solver first: every displacement is zero; *"])
