"""scikit-fem under scenes of Gronwall: in process, and by files with equal records."""

import csv
import subprocess
import sys
from pathlib import Path

import gronwall
import pytest
from viscoelastic import solve


def test_sound(order_study):
    order_study.verify("viscoelastic", solve)


def test_quadratic_elements(order_study):
    order_study.verify("quadratic-elastic", solve)


def test_midpoints_between_linear_values_are_caught():
    def linear(case):
        u = solve(case)
        for middle, (a, b) in zip((3, 4, 5), ((0, 1), (1, 2), (2, 0))):
            u[:, case.cells[:, middle]] = (u[:, case.cells[:, a]] + u[:, case.cells[:, b]]) / 2
        return u

    verdicts = gronwall.verify("quadratic-elastic", linear)
    assert {verdict.decision for verdict in verdicts} == {"fail"}


def test_a_rule_of_lower_order_is_caught():
    verdicts = gronwall.verify("prony", lambda case: solve(case, "rectangle"))
    assert {verdict.decision for verdict in verdicts} != {"pass"}


def records(directory):
    with open(directory / "cases.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["status"] for row in rows} == {"converged"}
    # In process a row as each case ends; the checksum is of the seconds too.
    rows.sort(key=lambda row: (int(row["n"]), row["norm"]))
    return [{key: row[key] for key in row if not key.startswith(("seconds", "checksum"))} for row in rows]


@pytest.mark.parametrize("scene", ["viscoelastic", "quadratic-elastic"])
def test_records_are_those_by_files(tmp_path, scene):
    gronwall.verify(scene, solve, n=[8, 16], out=tmp_path / "here")
    program = Path(__file__).with_name("viscoelastic.py")
    command = [sys.executable, "-m", "gronwall", "verify", scene, "--n", "8,16", "--out", "files"]
    subprocess.run([*command, "--solver", f"'{sys.executable}' '{program}'"], cwd=tmp_path, check=False)
    assert records(tmp_path / "here") == records(tmp_path / "files")
