"""Damaged tables before the reader of `sweep fit` and before a second reader that shares nothing with it.

    cargo build --release -p gronwall-judge --example tables
    python3 tests/fuzz/tables.py target/release/examples/tables [COUNT] [SEED]

Texts are tables made here and those of tests/pasted, changed as people and programs change them: rows, columns and separators, units, rates,
titles, prose, commas, exponents, gaps, signs, bytes. The second reader takes plain tables alone: a line of names, and below it rows of as many
numbers. What it reads, the reader under test reads alike, or refuses, or names as left out; it never reads anything else there.
"""

import json
import math
import random
import re
import subprocess
import sys
import time
import tomllib
from pathlib import Path

# The second reader.

MISSING = {"", "-", "--", "---", "*", "n/a", "na", "none", "nan"}
LENGTH = {"h": 0, "hmax": 0, "dx": 0, "meshsize": 0, "k": 1, "dt": 1, "tau": 1, "timestep": 1}
COUNT = {"n": 0, "nx": 0, "ny": 0, "nz": 0, "steps": 1, "nt": 1, "nsteps": 1}
CELLS = {"cells", "ncells", "elements", "dof", "dofs", "ndofs", "ndof", "ne", "unknowns"}
LEVEL = {"level", "lvl", "refinement", "refinementlevel"}
ERRORS = ("err", "l2", "h1", "h2", "linf", "l1", "energy", "max")
RATES = ("rate", "eoc", "order", "slope", "roc")
FLOAT = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")


class Unsure(Exception):
    """A person would ask."""


def bare(name):
    return re.sub(r"[^a-z0-9]", "", name.lower().replace("∞", "inf").replace("\\hline", ""))


def kind(name):
    plain = bare(re.split(r"[\[(]", name)[0]) or bare(name)
    if "||" in name:
        return "error"
    if plain in LENGTH or plain in COUNT or plain in CELLS or plain in LEVEL:
        return "size"
    if any(rate in plain for rate in RATES):
        return "rate"
    if (plain in ("e", "u", "eu", "inf") or any(error in plain for error in ERRORS)) and not re.search("log|iter|expect|theor|floor", plain):
        return "error"
    return "other"


def kinds(names):
    """What a rate follows is an error."""
    known = [kind(name) for name in names]
    behind = zip(names, known, [*known[1:], ""])
    return ["error" if name and of == "other" and after == "rate" else of for name, of, after in behind]


def number(cell):
    """The value of a cell, None where it is missing; a ValueError if it is a word."""
    text = cell.strip().strip("$`").replace("−", "-").replace(",", ".")
    if text.lower() in MISSING:
        return None
    if found := FLOAT.fullmatch(text):
        return float(re.sub("[dD]", "e", found[0]))
    if found := re.fullmatch(r"(\d+)/(0*[1-9]\d*)", text):
        return int(found[1]) / int(found[2])
    if found := re.fullmatch(r"2\^\{?(-?\d+)\}?", text):
        return 2.0 ** int(found[1])
    if found := re.fullmatch(r"([\d.]+)\s?(?:\\times|×|x|\\cdot)\s?10\^\{?([+-]?\d+)\}?", text):
        return float(f"{float(found[1])}e{found[2]}")
    if found := re.fullmatch(r"([\d.eE+-]+) ?\\?%", text):
        return float(found[1]) / 100
    if re.fullmatch(r"[+-]?\d*[.,]?\d+.*", text) and not re.search("[g-wyzG-WYZ]{4}", text):
        raise Unsure(text)
    raise ValueError(text)


def pointed(column):
    """The numbers of a column with decimal points, without thousands."""
    commas = [cell for cell in column if "," in cell]
    grouped = [cell for cell in commas if re.fullmatch(r"[1-9]\d{0,2}(,\d{3})+", cell)]
    if commas and (grouped or any("." in cell for cell in column)) and (len(grouped) < len(commas) or len(commas) < len(column)):
        raise Unsure("commas of two kinds")
    if grouped and any(cell.count(",") == 1 for cell in grouped):
        raise Unsure("2,312 may be a fraction")
    return [cell.replace(",", "" if grouped else ".") for cell in column]


def numeric(cell):
    try:
        number(cell)
    except ValueError:
        return False
    return True


def cut(line, separator):
    if separator == "latex":
        return [cell.strip() for cell in line.split("\\\\")[0].split("&")]
    if separator == "|":
        line = line.strip().removeprefix("|").removesuffix("|")
    return [cell.strip().strip('"').strip() for cell in (line.split() if separator is None else line.split(separator))]


def parted(lines):
    """Rows of LaTeX may stand in one line."""
    pieces = [(line, [piece for piece in line.split("\\\\") if "&" in piece]) for line in lines]
    return [row for line, rows in pieces for row in (rows if len(rows) > 1 else [line])]


def is_rule(line):
    return re.fullmatch(r"[-+|=:_#*~. \t]*", line) or re.match(r"\s*\\(hline|toprule|midrule|bottomrule|begin|end)\b[^&]*$", line)


def blocks(lines, separator):
    """Names and rows of the tables; Unsure where a line is neither prose nor a row of one."""
    found, at = [], 0
    while at < len(lines):
        line = lines[at]
        at += 1
        names = cut(line, separator)
        known = kinds(names)
        if separator is None and re.match(r"\||.*\t", line.strip()) or '"' in line or re.search("begin|hline.*[&]", line):
            raise Unsure(line)
        # `H1 ate` among names that stand far apart may be one name; `order u` is that of `u`.
        if separator is None and re.search(r"\S[ \xa0]\S", line.strip()) and re.search(r"\S {3,}\S", line):
            raise Unsure(line)
        if any(of == "rate" and " " in name and bare(name.split(" ")[1]) in map(bare, names) for name, of in zip(names, known)):
            raise Unsure("a rate of a name")
        if len(names) < 2 or any(name and numeric(name) for name in names) or "error" not in known:
            if len(re.findall(r"(?<![\w.])[-+.]?\d", line)) > 1 or kind(line) == "error":
                raise Unsure(line)
            continue
        if any(name.count("[") + name.count("(") > name.count("]") + name.count(")") or re.search("(?i)norm|multicolumn|percent|htime|errors?rate|[;,&=\t]|^[|]+$", name) for name in names):
            raise Unsure(line)
        if any(of == "size" and after == "rate" for of, after in zip(known, known[1:])):
            raise Unsure("a rate behind a size")
        if not all(names[1:]) or any(name and not bare(name) and "|" not in name for name in names):
            raise Unsure("a column without a name")
        rows = []
        while at < len(lines):
            cells = cut(lines[at], separator)
            if lines[at] == line and rows:
                raise Unsure(line)
            if is_rule(lines[at]) or lines[at] == line:
                at += 1
            elif len(cells) > 1 and any(numeric(cell) and cell not in MISSING for cell in cells):
                if lines[at].lstrip()[0] in "#%" or "," in cells:
                    raise Unsure(lines[at])
                if separator == "latex" and "\\\\" not in lines[at]:
                    raise Unsure("a row over two lines")
                rows.append(cells)
                at += 1
            else:
                break
        if at < len(lines) and FLOAT.fullmatch(lines[at].strip(" |")):
            raise Unsure(lines[at])
        if separator is None and any(of == "error" and cell in MISSING for of, cell in zip(known, rows[0] if rows else [])):
            raise Unsure("a name of two words above a rate")
        if rows:
            found.append((names, rows))
    return found


def sized(names, rows, asked):
    """Of each row h and k, NaN where the table has none."""
    places = [at for at, name in enumerate(names) if kind(name) == "size"]
    steps = [[math.nan] * len(rows), [math.nan] * len(rows)]
    plain = [bare(re.split(r"[\[(]", name)[0]) for name in names]
    lengths = [at for at in places if plain[at] in LENGTH]
    others = [at for at in places if at not in lengths]
    if len({LENGTH[plain[at]] for at in lengths}) < len(lengths) or len(others) > 1:
        raise Unsure("two sizes")
    if others and (lengths or plain[others[0]] in CELLS and not asked.get("dimension")):
        # Beside a length the count says the same, or more than this reader knows.
        raise Unsure("a count beside a length, or without a dimension")
    for at in places:
        values = [number(row[at]) for row in rows]
        if any(value is None or not math.isfinite(value) for value in values):
            raise Unsure("a gap among the sizes")
        if plain[at] in LENGTH:
            if all(value >= 1 and value == int(value) for value in values):
                raise Unsure("a length that counts")
            steps[LENGTH[plain[at]]] = values
        elif any("%" in row[at] for row in rows):
            raise Unsure("percent of a count")
        elif plain[at] in COUNT:
            less = beyond_cells(values) if COUNT[plain[at]] == 0 else 0
            steps[COUNT[plain[at]]] = [1 / (value - less) if value else math.inf for value in values]
        elif plain[at] in CELLS:
            steps[0] = [value ** (-1 / asked["dimension"]) if value > 0 else math.inf for value in values]
        elif len(set(values)) > 3 and geometric(values, 0):
            raise Unsure("levels 1, 2, 4, 8 may be factors")
        else:
            steps[0] = [asked.get("ratio", 2.0) ** -value for value in values]
    if not places:
        if not asked.get("ratio") or "other" in kinds(names):
            raise Unsure("no size")
        steps[asked.get("in_time", False)] = [asked["ratio"] ** -at for at in range(len(rows))]
    return list(zip(*steps))


def geometric(numbers, more):
    distinct = sorted(set(numbers))
    return all((b + more) ** 2 == (a + more) * (c + more) for a, b, c in zip(distinct, distinct[1:], distinct[2:]))


def beyond_cells(numbers):
    """1 where 11, 21, 41 are one more than 10, 20, 40, and -1 where 9, 19, 39 are one less."""
    if len(set(numbers)) < 3 or min(numbers) <= 2 or geometric(numbers, 0):
        return 0
    return 1 if geometric(numbers, -1) else -1 if geometric(numbers, 1) else 0


def second(text, asked):
    """Name of an error to the set of its (h, k, error); None where a person would ask."""
    lines = [line for line in re.split("\r?\n", text) if line.strip()]
    if text.count('"') % 2 or any(ord(c) < 32 and c not in "\t\n\r" for c in text):
        return None
    answers = []
    for separator in ["latex", "|", "\t", ";", ",", None]:
        if separator and ("&" if separator == "latex" else separator) not in text:
            continue
        try:
            answer = {}
            for names, rows in blocks(parted(lines) if separator == "latex" else lines, separator):
                if any(len(row) != len(names) for row in rows):
                    raise Unsure("rows of other widths")
                known = kinds(names)
                twice = [bare(name) for name, of in zip(names, known) if of in ("size", "error")]
                if len(set(twice)) < len(twice):
                    raise Unsure("a column stands twice")
                rows = [list(row) for row in zip(*map(pointed, zip(*rows)))]
                sizes = sized(names, rows, asked)
                for at, name in enumerate(names):
                    if known[at] == "error":
                        values = [number(row[at]) for row in rows]
                        there = [value for value in values if value is not None]
                        if 0 in there:
                            raise Unsure("an error of 0")
                        if there and min(there) < 0:
                            values = [value and abs(value) for value in values]
                        points = [(h, k, value) for (h, k), value in zip(sizes, values) if value is not None and math.isfinite(value)]
                        answer.setdefault(bare(name), []).extend(points)
            answers += [answer] if answer else []
        except (Unsure, ValueError, OverflowError):
            pass
    return answers[0] if answers and all(answer == answers[0] for answer in answers) else None


def near(one, other):
    return all(a == b or math.isnan(a) and math.isnan(b) or abs(a - b) <= 1e-9 * abs(b) for a, b in zip(one, other))


def difference(found, answer):
    """What the reader under test read and the second did not, or the reverse; None if they agree."""
    value = lambda entry: math.nan if entry is None else entry
    read = {}
    for table in found["tables"]:
        # A row without a size or an error is a gap, which is told.
        points = [tuple(map(value, row[1:4])) for row in table["rows"] if row[3] is not None and row[1:3] != [None, None]]
        read.setdefault(bare(table["norm"] or ""), []).extend(points)
    # A column called `error` needs no name, in several tables neither.
    if "" in read:
        plain = [name for name in answer if name in ("error", "err")] or list(answer)[:1]
        one = {name for name in read if name in ("", *plain)}
        answer[""] = [point for name in plain for point in answer.pop(name)]
        read[""] = [point for name in one for point in read.pop(name)]
    said = "\n".join(found["said"])
    # Of columns that are errors by their numbers the second reader knows nothing; their guess is said.
    taken = re.findall("((?:`[^`]*`,? ?)+)taken for errors", said)
    guessed = [bare(name) for part in taken for name in re.findall("`(.*?)`", part)]
    for name, points in read.items():
        known = answer.get(name)
        if name in guessed:
            continue
        if known is None and not re.match(r"e[a-z]?r|h\d|uu", name):
            return f"`{name}` is no error"
        for point in points:
            if known is not None and not any(near(point, other) for other in known):
                return f"`{name}` has no {point}"
    lines_left = re.search("left out: .*(line| more)", said)
    left_out = [bare(name) for part in re.findall("left out: (.*)", said) for name in re.findall("`(.*?)`", part)]
    for name, points in answer.items():
        gaps = any(row[4] for table in found["tables"] for row in table["rows"])
        # Without its names a column is guessed.
        if name in left_out or "not read" in said or lines_left or gaps or any(re.match("column", other) for other in guessed):
            continue
        if name not in read:
            return f"`{name}` is lost"
        for point in points:
            if not any(near(point, other) for other in read[name]):
                return f"{point} of `{name}` is lost"
    return None


# Texts.


def made(rng):
    """A table as a program prints it."""
    levels = rng.randint(2, 7)
    order = [rng.choice([0.5, 1, 1.5, 2, 3, 4]) for _ in range(3)]
    first = rng.choice([1.0, 0.5, 0.1, 0.3])
    sides = [rng.choice([2, 4, 5, 10])]
    while len(sides) < levels:
        sides.append(rng.choice([2, 2, 2, 3]) * sides[-1])
    size = rng.choice(["h", "dx", "hmax", "k", "dt", "tau", "n", "N", "nx", "steps", "dofs", "cells", "level"])
    style = rng.choice(["{:.4e}", "{:.3E}", "{:.6g}", "{:.8f}", "{!r}"])
    cells = {
        "length": [style.format(1 / n) for n in sides],
        "n": [str(n) for n in sides],
        "dofs": [str((n + 1) ** 2) for n in sides],
        "cells": [str(n * n) for n in sides],
        "level": [str(i) for i in range(levels)],
    }
    columns = [[size, *cells[{"N": "n", "nx": "n", "steps": "n"}.get(size, size if size in cells else "length")]]]
    for at, name in enumerate(rng.sample(["L2", "H1", "error", "L2_error", "err_u", "Linf", "energy", "H1 error", "||u-u_h||"], rng.randint(1, 3))):
        errors = [first / n ** order[at] * rng.uniform(0.9, 1.1) for n in sides]
        columns.append([name, *map(style.format, errors)])
        if rng.random() < 0.3:
            rates = [math.log(a / b) / math.log(2) for a, b in zip(errors, errors[1:])]
            columns.append([rng.choice(["rate", "EOC", "order"]), rng.choice(["-", "", "nan", "0"]), *map("{:.2f}".format, rates)])
    if rng.random() < 0.2:
        columns.append(["time", *("{:.2f}".format(0.1 * n) for n in sides)])
    return [list(row) for row in zip(*columns)]


def rendered(rng, rows):
    way = rng.choice(["csv", "csv", "semicolon", "tab", "blanks", "blanks", "pipes", "markdown", "latex"])
    join = {"csv": ",", "semicolon": ";", "tab": "\t"}.get(way)
    if join:
        return "\n".join(join.join(row) for row in rows) + "\n"
    width = max(len(cell) for row in rows for cell in row)
    if way == "blanks":
        return "\n".join("  ".join((cell.replace(" ", "_") or "-").rjust(width) for cell in row) for row in rows) + "\n"
    if way == "latex":
        body = [" & ".join(row) + " \\\\" for row in rows]
        return "\n".join(["\\begin{tabular}{rrr}", "\\hline", body[0], "\\hline", *body[1:], "\\hline", "\\end{tabular}"]) + "\n"
    body = ["| " + " | ".join(cell.rjust(width) for cell in row) + " |" for row in rows]
    return "\n".join([body[0], *(["|" + "---|" * len(rows[0])] if way == "markdown" else []), *body[1:]]) + "\n"


def reshaped(rng, rows):
    """One change of the table itself."""
    at, width = rng.randrange(1, len(rows)), min(map(len, rows))
    column = rng.randrange(width)
    what = rng.randrange(14)
    if what == 0 and len(rows) > 2:
        del rows[at]
    elif what == 1:
        other = rng.randrange(width)
        for row in rows:
            row[column], row[other] = row[other], row[column]
    elif what == 2:
        unit = rng.choice([" m", "s", "%", " %", "ms"])
        for row in rows[1:] if rng.random() < 0.5 else [rows[at]]:
            row[column] += unit
    elif what == 3:
        for row in rows[1:]:
            row[column] = row[column].replace(".", ",")
    elif what == 4:
        for row in rows[1:]:
            row[column] = f"{int(row[column]) * 1000:,}" if row[column].isdigit() else row[column]
    elif what == 5:
        for row in rows[1:]:
            row[:] = [cell.replace("e-", "D-").replace("E-", "D-") for cell in row]
    elif what == 6:
        rows[at][column] = rng.choice(["", "-", "nan", "n/a", "--", "inf", "0", "***", "diverged"])
    elif what == 7:
        rows.insert(rng.randrange(1, len(rows) + 1), list(rng.choice(rows)))
    elif what == 8:
        cells = [rows[at]] if rng.random() < 0.5 else rows[1:]
        for row in cells:
            row[column] = "-" + row[column]
    elif what == 9:
        rows[:] = [list(row) for row in zip(*rows)]
    elif what == 10:
        head, from_ = rng.choice(["", "#", "i", "case", None]), rng.choice([0, 1])
        names = [str(i + from_) if rng.random() < 0.9 else f"run{i}" for i in range(len(rows) - 1)]
        rows[:] = [([] if head is None else [head]) + rows[0], *([name, *row] for name, row in zip(names, rows[1:]))]
    elif what == 11:
        rng.shuffle(rows[1:])
        rows[1:] = rows[:0:-1]
    elif what == 12:
        del rows[at][column]
    else:
        for row in rows:
            del row[column]
    return len(rows) > 1 and min(map(len, rows)) > 0


PROSE = ["Convergence study", "# made by a program", "% results", "Degree 2 on the unit square:", "done in 3.2 s", "Iteration 3: 12 cells", "====", "--------", "\n",
         "mean 1.98", "L2 errors", "rates", "Solving with 4 threads", "h = 0.1", "Table 2: errors and orders", "EOC 2", "1 2 3", "error: 0.5", "Overall EOC: 1.98"]
BYTES = [",", ".", "-", "e", " ", "\n", "\t", "|", "&", "\\", "0", "1", "%", "=", ":", "h", "(", "[", "\"", "#", "×", "−", "\u00a0", "\0"]


def damaged(rng, text, other):
    """One change of the text."""
    lines = text.split("\n")
    at, place = rng.randrange(len(lines)), rng.randrange(len(text) + 1)
    what = rng.randrange(12)
    if what < 3:
        lines.insert(at, rng.choice(PROSE))
    elif what == 3:
        lines.insert(rng.choice([0, len(lines)]), rng.choice(["", "\n", "next\n"]) + other)
    elif what == 4:
        return text[:place]
    elif what == 5:
        return text[:place] + rng.choice(BYTES) + text[place:]
    elif what == 6:
        return text[:place] + text[place + rng.choice([1, 1, 2, 8]):]
    elif what == 7:
        del lines[at]
    elif what == 8:
        lines.insert(rng.randrange(len(lines)), lines[at])
    elif what == 9:
        one, two = rng.sample([",", ";", "\t", "  ", "|", " & "], 2)
        return text.replace(one, two)
    elif what == 10:
        lines[at] = rng.choice(["# ", "> ", "    ", "% ", "$ "]) + lines[at]
    else:
        lines[at:at] = ["", text, ""] if rng.random() < 0.5 else [lines[0]]
    return "\n".join(lines)


def texts(rng, pasted):
    while True:
        rows = made(rng)
        for _ in range(rng.choice([0, 1, 1, 2])):
            if not reshaped(rng, rows):
                break
        else:
            text = rendered(rng, rows) if rng.random() < 0.85 else rng.choice(pasted)
            for _ in range(rng.choice([0, 0, 1, 1, 2, 3])):
                text = damaged(rng, text, rendered(rng, made(rng)) if rng.random() < 0.7 else rng.choice(pasted))
            asked = {"text": text}
            for key, value in [("dimension", 2), ("ratio", 2.0), ("runs", True), ("in_time", True)]:
                if rng.random() < (0.5 if key == "dimension" else 0.15):
                    asked[key] = value
            yield asked


def main(program, count="20000", seed="1"):
    rng, count = random.Random(int(seed)), int(count)
    pasted = [
        table["text"]
        for path in sorted((Path(__file__).parent.parent / "pasted").glob("*.toml"))
        for table in tomllib.loads(path.read_text(encoding="utf-8"))["table"]
    ]
    source, counts, slowest, bad = texts(rng, pasted), dict.fromkeys(["read", "refused", "read twice", "refused though read"], 0), 0.0, 0
    began = time.time()
    for done in range(0, count, 2000):
        batch = [next(source) for _ in range(min(2000, count - done))]
        run = subprocess.run([program], input="\n".join(map(json.dumps, batch)) + "\n", capture_output=True, text=True, timeout=600)
        found = [json.loads(line) for line in run.stdout.split("\n") if line]
        if len(found) < len(batch):
            sys.exit(f"a panic: {json.dumps(batch[len(found)])}\n{run.stderr}")
        for asked, answer in zip(batch, found):
            slowest = max(slowest, answer["seconds"])
            known = second(asked["text"], asked)
            counts["refused" if "refused" in answer else "read"] += 1
            if known is None:
                continue
            counts["refused though read" if "refused" in answer else "read twice"] += 1
            if "refused" not in answer and (why := difference(answer, known)):
                bad += 1
                if bad < 200:
                    print(json.dumps({"why": why, "said": answer["said"], **asked}, ensure_ascii=False))
    print(f"{count} texts: {counts}, {bad} read otherwise, slowest {slowest:.3f} s, {time.time() - began:.0f} s")
    # A text has some kilobytes: a second is no reading any more. Half of the texts at least are read by both.
    sys.exit(bad > 0 or slowest > 1 or counts["read twice"] < count / 5)


if __name__ == "__main__":
    main(*sys.argv[1:])
