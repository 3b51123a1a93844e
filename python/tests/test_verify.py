"""A solver in process under a scene: the case as arrays, records as those by files, what is refused."""

import csv
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import pytest

import gronwall

numpy = pytest.importorskip("numpy")

GRID = {"n": [4, 8, 16], "steps": [4]}


def exact(case):
    """The displacements of viscoelastic, interpolated; any fixed field would do."""
    x, y = case.points.T
    t = case.times[:, None]
    return numpy.stack([0.1 * (1 + t) * (1 - y) * x, 0.05 * t * (1 - y) * numpy.sin(x)], axis=-1)


def test_scenes_have_questions():
    assert "viscoelastic" in gronwall.scenes() and all(gronwall.scenes().values())


def test_the_case_is_complete():
    seen = []

    def solve(case):
        seen.append(case)
        return numpy.zeros_like(case.loads)

    gronwall.verify("signorini", solve, n=[4], steps=[3])
    case = seen[0]
    assert (case.scene, case.dimension, case.n, case.steps) == ("signorini", 2, 4, 3)
    assert case.points.shape == (25, 2) and case.cells.shape == (32, 3) and case.loads.shape == (4, 25, 2)
    corners = case.points[case.cells]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = numpy.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]).sum() / 2
    assert abs(area - 1) < 1e-14
    assert abs(case.contact["weight"].sum() - 1) < 1e-14 and (case.contact["normal"] == [0, -1]).all()
    assert (case.points[case.clamped, 1] == 1).all() and case.clamped.sum() == 5
    assert not case.loads[:, case.clamped].any() and case.loads.any()
    assert len(case.sides) == len(case.facets) == 16 and case.times[-1] == case.data["horizon"]


def test_pressures_that_nothing_judges_are_said():
    def solve(case):
        return numpy.zeros_like(case.loads), numpy.zeros((case.steps + 1, len(case.contact["vertex"])))

    with pytest.warns(UserWarning, match="no claim of affine needs the pressures"):
        gronwall.verify("affine", solve, n=[2], steps=[4], pressure=True)
    names = {verdict.name for verdict in gronwall.verify("signorini", solve, n=[4], steps=[2], pressure=True)}
    assert "signorini pressure_L2_max" in names


def test_gap_and_shift_are_those_of_the_scene():
    seen = []

    def solve(case):
        seen.append(case)
        return numpy.zeros_like(case.loads)

    gronwall.verify("broken-gap", solve, n=[4], steps=[2])
    case = seen[0]
    x = case.points[case.contact["vertex"], 0]
    assert sorted(x) == [0, 0.25, 0.5, 0.75, 1]
    # As the file of the scene has them.
    assert abs(case.contact["gap"] - (0.08 + 0.1 * (x - 0.5) ** 2)).max() < 1e-15
    assert abs(case.contact["shift"] - 0.1 * (x - 0.5) ** 2).max() < 1e-15
    # Half of a side at the ends; clamped at the top alone.
    assert abs(case.contact["weight"] - numpy.where((x == 0) | (x == 1), 0.125, 0.25)).max() < 1e-15
    assert (case.contact["scale"] == 1).all() and not case.contact["clamped"].any()


def test_midpoints_of_quadratic_elements_and_bounds_of_friction_are_there():
    seen = []

    def solve(case):
        seen.append(case)
        return numpy.zeros_like(case.loads)

    gronwall.verify("quadratic-friction", solve, n=[4], steps=[5])
    case = seen[0]
    assert case.data["element"] == "P2" and case.data["midpoints"] == 56
    assert case.points.shape == (81, 2) and case.cells.shape == (32, 6) and case.loads.shape == (6, 81, 2)
    for middle, (a, b) in zip((3, 4, 5), ((0, 1), (1, 2), (2, 0))):
        ends = case.points[case.cells[:, a]] + case.points[case.cells[:, b]]
        assert numpy.allclose(case.points[case.cells[:, middle]], ends / 2, rtol=0, atol=1e-15)
    assert case.facets.shape == (16, 3) and case.friction.shape == (6, len(case.contact["weight"]))
    assert case.friction.all() and abs(case.contact["weight"].sum() - 1) < 1e-14


def rows(path):
    with open(path, newline="") as file:
        table = list(csv.DictReader(file))
    # A row as each case ends there, sorted here; the checksum is of the seconds too.
    table.sort(key=lambda row: (int(row["n"]), row["norm"]))
    return [{key: row[key] for key in row if not key.startswith(("seconds", "checksum"))} for row in table]


def test_records_in_process_are_those_by_files_bit_for_bit(tmp_path):
    script = tmp_path / "solve.py"
    script.write_text(
        textwrap.dedent(
            """
            import csv, sys, numpy
            folder = sys.argv[1]
            with open(f"{folder}/vertices.csv") as file:
                points = numpy.array([[float(row["x"]), float(row["y"])] for row in csv.DictReader(file)])
            t = numpy.load(f"{folder}/times.npy")[:, None]
            x, y = points.T
            u = numpy.stack([0.1 * (1 + t) * (1 - y) * x, 0.05 * t * (1 - y) * numpy.sin(x)], axis=-1)
            numpy.save(f"{folder}/displacement.npy", u)
            """
        )
    )
    verdicts = gronwall.verify("viscoelastic", exact, **GRID, out=tmp_path / "here")
    command = [sys.executable, "-m", "gronwall", "verify", "viscoelastic", "--n", "4,8,16", "--steps", "4"]
    command += ["--solver", f"{sys.executable} {script}", "--out", str(tmp_path / "files")]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    here, files = rows(tmp_path / "here/cases.csv"), rows(tmp_path / "files/cases.csv")
    assert here == files and {row["status"] for row in here} == {"converged"}
    # A field that is no solution has no order.
    assert run.returncode == 1 and {verdict.decision for verdict in verdicts} == {"fail"}


def test_what_the_solver_raises_comes_out_as_it_was_and_ends_the_sweep():
    calls = []

    def solve(case):
        calls.append(case.n)
        raise ZeroDivisionError("the mesh is odd")

    with pytest.raises(ZeroDivisionError, match="the mesh is odd") as caught:
        gronwall.verify("viscoelastic", solve, **GRID)
    assert len(calls) == 1 and caught.traceback[-1].name == "solve"


def test_the_solver_is_called_on_the_thread_of_verify():
    seen = set()

    def solve(case):
        seen.add(threading.get_ident())
        return exact(case)

    gronwall.verify("viscoelastic", solve, n=[4, 8], steps=[2])
    assert seen == {threading.get_ident()}


def interrupted(solve):
    """The frames of a KeyboardInterrupt, and the seconds that it took."""
    sent = []

    def send():
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    # A shell that starts the tests in the background has SIGINT ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt) as caught:
            solve(send)
    finally:
        signal.signal(signal.SIGINT, before)
    return [entry.name for entry in caught.traceback], time.perf_counter() - sent[0]


def test_an_interrupt_in_the_solver_ends_it_where_it_stands():
    def solve(case):
        solve.send()
        time.sleep(60)

    def run(send):
        solve.send = send
        gronwall.verify("viscoelastic", solve, **GRID)

    frames, seconds = interrupted(run)
    assert frames[-2] == "solve" and seconds < 5


def test_an_interrupt_between_two_calls_of_the_solver_ends_the_sweep():
    calls = []

    def run(send):
        def solve(case):
            # Falls into the errors of the program on the finest mesh, which is the first.
            calls.append(case.n)
            threading.Timer(0.3, send).start()
            return numpy.zeros_like(case.loads)

        gronwall.verify("viscoelastic", solve, n=[64, 256], steps=[64])

    _, seconds = interrupted(run)
    assert calls == [256] and seconds < 5


def test_verdicts_that_do_not_pass_name_the_solver_first():
    def lines(scale, n):
        solved = lambda case: scale * exact(case)
        return [verdict.reason for verdict in gronwall.verify("viscoelastic", solved, n=n, steps=[4])]

    # Errors that do not fall are no matter of the memory.
    for reason in lines(1.1, [4, 8, 16]):
        symptom, loads, finding = (reason.index(word) for word in ("errors do not fall", "loads", "? "))
        assert reason.startswith("look at the solver first") and symptom < loads < finding
        assert "memory sum" not in reason
    # Two cases have no order, whatever the solver does.
    assert all(reason.startswith("2 points") for reason in lines(1.0, [4, 8]))


@pytest.mark.parametrize(
    ("scene", "solve", "says"),
    [
        ("viscoelastic", lambda case: numpy.zeros((2, 2)), r"shape \(2, 2\) where \(5, \d+, 2\) is wanted"),
        ("viscoelastic", lambda case: numpy.full(case.loads.shape, numpy.nan), "nan at"),
        ("viscoelastic", lambda case: numpy.ma.masked_array(exact(case), mask=True), "masked"),
        ("viscoelastic", lambda case: [numpy.ma.masked_array(u, mask=True) for u in exact(case)], "masked"),
        ("viscoelastic", lambda case: exact(case) + 0j, "complex"),
        ("viscoelastik", exact, "viscoelastic"),
        ("punch", exact, "no exact solution"),
        ("abstract-smooth", exact, "R\\^m"),
    ],
)
def test_what_cannot_be_judged_is_refused(scene, solve, says):
    with pytest.raises(ValueError, match=says):
        gronwall.verify(scene, solve, **GRID)


def test_the_console_script_is_the_program(tmp_path):
    def sweep(*words):
        command = [sys.executable, "-m", "gronwall", *words]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)

    listed = sweep("list")
    assert listed.returncode == 0 and "scenes inside this program" in listed.stdout
    assert sweep("--version").stdout.split() == ["sweep", gronwall.__version__]
    bad = sweep("verify", "viscoelastik", "--solver", "true")
    assert bad.returncode == 2 and "did you mean `viscoelastic`" in bad.stderr
