"""A reader of tables that shares nothing with the one of the program: it reads what cannot be read two ways, and None is all else."""

import re

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
RULE = re.compile(r"[-=:+|\s]*|\s*\\(hline|toprule|midrule|bottomrule)\s*")
LENGTHS = {"h", "hmax", "dx"}
STEPS = {"dt", "deltat"}
COUNTS = {"n", "nx", "ny", "numpts"}
ERROR = re.compile(r"err|^l[12]$|^linf|^h1$|norm")
OTHER = re.compile(r"rate|order|eoc|ratio|log|expect|slope|reduction|conv|iter|residual|normal|floor|sigma")


def number(cell):
    """The number of a cell; None for a cell without one, NaN for what is no cell of numbers."""
    bare = cell.strip().strip("*`$").strip()
    if bare in ("", "-", "--", "---", "–", "—"):
        return None
    if NUMBER.fullmatch(bare) and abs(float(bare)) < float("inf"):
        return float(bare)
    parts = bare.split("/")
    if len(parts) == 2 and all(part.isdecimal() and int(part) for part in parts):
        return int(parts[0]) / int(parts[1])
    return float("nan")


def cuts():
    def pipes(line):
        return [cell.strip() for cell in line.strip().removeprefix("|").removesuffix("|").split("|")] if "|" in line else []

    def latex(line):
        return [cell.strip() for cell in line.split("\\\\")[0].split("&")] if "&" in line else []

    yield latex
    yield pipes
    for sign in "\t;,":
        yield lambda line, sign=sign: [cell.strip() for cell in line.split(sign)] if sign in line else []
    yield str.split


def normal(name):
    name = name.lower().split("(")[0].split("[")[0].replace("∞", "inf").replace("δ", "delta")
    return re.sub(r"[^a-z0-9]", "", name)


def blocks(text, cut):
    """Names and rows of every run of lines of numbers below a line of names."""
    above, rows, run = None, [], False
    for line in [*text.split("\n"), "the end"]:
        if RULE.fullmatch(line):
            run = run and bool(line.strip())
            continue
        cells = cut(line)
        numbers = [number(cell) for cell in cells]
        sound = len(cells) > 1 and all(n is None or n == n for n in numbers) and numbers[0] is not None
        if sound and above and len(cells) == len(above) and (run or not rows):
            rows.append(numbers)
            run = True
            continue
        if rows:
            yield above, rows
        # A line of numbers that does not fit spoils what is around it, and any with a number right behind the rows or as wide.
        if sound or (run or rows and len(cells) == len(above)) and any(n is None or n == n for n in numbers):
            yield None, None
        above, rows, run = (cells if all(n is not None and n != n for n in numbers) else None), [], False


def second(text):
    """Pairs of size and error of each column of errors, by its name."""
    for cut in cuts():
        found = list(blocks(text, cut))
        if not found:
            continue
        if len(found) > 1 or found[0][0] is None or len(found[0][1]) < 3:
            return None
        names, rows = found[0]
        kinds = [normal(name) for name in names]
        if len(set(names) - {name for name, kind in zip(names, kinds) if OTHER.search(kind)}) < sum(not OTHER.search(kind) for kind in kinds):
            return None
        sizes = [at for at, kind in enumerate(kinds) if kind in LENGTHS | STEPS]
        sizes = sizes or [at for at, kind in enumerate(kinds) if kind in COUNTS]
        errors = [at for at, kind in enumerate(kinds) if ERROR.search(kind) and not OTHER.search(kind)]
        # A column called error goes before those of norms.
        if len(errors) > 1 and {"error", "err"} & {kinds[at] for at in errors}:
            return None
        columns = {at: [row[at] for row in rows] for at in [*sizes, *errors]}
        # A word of a name may be a size too.
        words = {word for name in names for word in re.split(r"[^a-z]+", name.lower())}
        if kinds[sizes[0]] in COUNTS and words & (LENGTHS | STEPS) if sizes else True:
            return None
        if len(sizes) != 1 or not errors or any(n is None for column in columns.values() for n in column):
            return None
        steps = columns[sizes[0]]
        if kinds[sizes[0]] in COUNTS:
            counted = all(b == a + 1 for a, b in zip(steps, steps[1:]))
            if counted or any(n < 1 or n != int(n) for n in steps):
                return None
            steps = [1 / n for n in steps]
        if len(set(steps)) < len(steps) or min(steps) <= 0 or any(n < 0 for at in errors for n in columns[at]):
            return None
        return {names[at]: sorted(zip(steps, columns[at])) for at in errors}
    return None
