"""Tables as people have them, from Python: a text, a path, a dict and a frame are one table; what has no one number is refused."""

import pytest

import gronwall

TEXT = "Two norms\n\nn      L2        H1    rate\n8   1.0e-1  4.0e-1   -\n16  2.5e-2  2.0e-1  1.0\n32  6.25e-3 1.0e-1  1.0\n64  1.5625e-3 5e-2  1.0\n"
COLUMNS = {"n": [8, 16, 32, 64], "L2": [1e-1, 2.5e-2, 6.25e-3, 1.5625e-3], "H1": [4e-1, 2e-1, 1e-1, 5e-2]}


def content(tables):
    return [(table.name, table.h, table.errors) for table in tables]


def test_a_text_a_path_a_dict_and_a_frame_are_one_table(tmp_path):
    pandas = pytest.importorskip("pandas")
    numpy = pytest.importorskip("numpy")
    path = tmp_path / "table.txt"
    path.write_text(TEXT, encoding="utf-8")
    wanted = [("L2", (1 / 8, 1 / 16, 1 / 32, 1 / 64), tuple(COLUMNS["L2"])), ("H1", (1 / 8, 1 / 16, 1 / 32, 1 / 64), tuple(COLUMNS["H1"]))]
    arrays = {name: numpy.array(column) for name, column in COLUMNS.items()}
    for source in (TEXT, path, str(path), COLUMNS, arrays, pandas.DataFrame(COLUMNS)):
        tables = gronwall.read(source)
        assert content(tables) == wanted
        assert [table.fit(order).decision for table, order in zip(tables, (2, 1))] == ["pass", "pass"]
    assert gronwall.read(TEXT)[0].said == "read 4 rows: h from `n`, errors `L2`, `H1`; left out: `rate`"
    assert list(gronwall.read(COLUMNS)[0].frame()["error"]) == COLUMNS["L2"]


def test_options_are_those_of_the_command():
    heat = "dt,rho\n0.1,1e-2\n0.05,5e-3\n0.025,2.5e-3\n0.0125,1.25e-3\n"
    (table,) = gronwall.read(heat, errors="rho")
    verdict = table.fit(1)
    assert (verdict.decision, verdict.variable, verdict.name) == ("pass", "k", "rho")
    (table,) = gronwall.read("L2 x\n1e-2 1\n2.5e-3 1\n6.25e-4 1\n", ratio=2)
    assert table.h == (1, 0.5, 0.25)
    two = "degree,n,error\n" + "".join(f"{p},{n},{n ** -p!r}\n" for p in (1, 2) for n in (8, 16, 32, 64))
    tables = gronwall.read(two)
    assert [table.fit(p).decision for table, p in zip(tables, (1, 2))] == ["pass", "pass"]
    assert [table.name for table in tables] == ["degree=1", "degree=2"]
    holes = gronwall.read("h,error\n0.5,0.5\n0.25,0.25\n0.125,\n0.0625,0.0625\n")[0]
    assert (holes.fit(1).decision, holes.fit(1).reason) == ("fail", "line 4: no error")
    (grid,) = gronwall.read("h,k,error\n0.5,0.1,1\n0.25,0.1,1\n0.5,0.05,1\n")
    with pytest.raises(ValueError, match="both refined"):
        grid.fit(1)


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"h": [0.5, 0.25], "error": [1j, 2j]}, r"error\[0\]: 1j is a complex number"),
        ({"h": [0.5, 0.25], "error": [[1], [2]]}, r"error\[0\]: list is no number and no word"),
        ({"h": [0.5, 0.25], "error": [1.0]}, "different length"),
        ({"x": [0.5, 0.25], "error": [1, 2]}, "line 1: no column of sizes"),
        (7, "int: a text, a path"),
    ],
)
def test_what_has_no_one_number_is_refused(columns, words):
    with pytest.raises(ValueError, match=words):
        gronwall.read(columns)


def test_masked_and_object_arrays_are_refused():
    numpy = pytest.importorskip("numpy")
    masked = numpy.ma.array([1.0, 0.5], mask=[False, True])
    with pytest.raises(ValueError, match="masked"):
        gronwall.read({"h": [0.5, 0.25], "error": masked})
    with pytest.raises(ValueError, match="no number and no word"):
        gronwall.read({"h": [0.5, 0.25], "error": numpy.array([object(), object()])})
