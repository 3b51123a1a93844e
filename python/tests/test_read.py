"""Tables as people have them, from Python: a text, a path, a dict and a frame are one table; what has no one number is refused;
pasted tables and damaged ones are read as a second reader reads them, or not at all."""

import math
import pathlib
import random
import tomllib

import pytest
from second_reader import second

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


PASTED = pathlib.Path(__file__).parents[2] / "tests" / "pasted"
WORDS = "0 -1 nan inf 1e400 | & , ; = : h error L2 rate e - -- 0,5 1.5-3 $ { } ( # % x 10^ 1/0".split(" ")


def pasted():
    """The tables that are read without a word from a caller."""
    asked = {"dimension", "ratio", "by", "runs", "errors"}
    tables = [table for path in sorted(PASTED.glob("*.toml")) for table in tomllib.loads(path.read_text(encoding="utf-8"))["table"]]
    return [table["text"] for table in tables if not asked & table.keys()]


def damaged(text, generator):
    for _ in range(generator.randint(1, 3)):
        at, to = sorted(generator.randrange(len(text) + 1) for _ in range(2))
        to = min(to, at + generator.choice([2, 12, 60]))
        lines = text.split("\n")
        line, other = generator.randrange(len(lines)), generator.randrange(len(lines))
        kind = generator.randrange(7)
        if kind == 0:
            text = text[:at] + text[to:]
        elif kind == 1:
            text = text[:to] + text[at:to] + text[to:]
        elif kind == 2:
            text = text[:at] + generator.choice("0123456789.,e- \nx|=:[%&") + text[at + 1 :]
        elif kind == 3:
            text = text[:at] + generator.choice(WORDS) + text[at:]
        else:
            if kind == 4:
                lines.pop(line)
            elif kind == 5:
                lines.insert(other, lines[line])
            else:
                lines[line], lines[other] = lines[other], lines[line]
            text = "\n".join(lines)
    return text


def agree(text, wanted):
    """Whether both readers read the text, and then that they read the same."""
    if wanted is None:
        return False
    try:
        tables = gronwall.read(text)
    except ValueError:
        return False
    read = [sorted(zip((k if math.isnan(h) else h for h, k in zip(table.h, table.k)), table.errors)) for table in tables]
    for name, points in wanted.items():
        # A size that is printed twice with other digits is one size, whose errors are averaged: the second reader has both.
        sizes = [size for size, _ in points]
        if any(a != b and math.isclose(a, b, rel_tol=1e-9) for a, b in zip(sizes, sizes[1:])):
            return False
        # Sizes follow from counts by a division: a rounding.
        near = [levels for levels in read if [e for _, e in levels] == [e for _, e in points]]
        close = lambda levels: all(math.isclose(a, b, rel_tol=1e-15) for (a, _), (b, _) in zip(levels, points))
        assert any(map(close, near)), (name, text)
    return True


def test_tables_are_read_as_a_second_reader_reads_them_or_not_at_all():
    texts = pasted()
    assert sum(agree(text, second(text)) for text in texts) >= 12
    generator = random.Random(1)
    both = 0
    for _ in range(20_000):
        text = damaged(generator.choice(texts), generator)
        both += agree(text, second(text))
    assert both > 500
