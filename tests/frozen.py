"""Frozen answers: what the program says of every scene, and of ten scenes in every study, kept while the code behind it is replaced.

    python3 tests/frozen.py record SWEEP [FOLDER]     runs SWEEP and writes FOLDER (tests/frozen)
    python3 tests/frozen.py compare SWEEP [FOLDER]    runs SWEEP and lists what differs; exit code 1 if anything does

Errors may differ by 1e-10 of themselves or by their floor, whichever is larger; statuses, verdicts and the words and booleans of
studies not at all, their numbers by 1e-6. A scene that is gone or new is listed and is no difference.
"""

import csv
import gzip
import io
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time

STUDIED = ["affine", "pure-mild", "compliance", "signorini", "friction-slip", "quadratic-front", "viscoelastic",
           "abstract-contact", "linear-punch", "layered"]
STUDIES = {"bound": ["--n", "4"], "gronwall": [], "audit": ["--n", "8,16"], "diagnose": ["--always"], "check": []}
# Clocks and sizes of a run are no answers.
LEFT_OUT = ("second", "bytes", "provenance", "version", "iterations", "factorizations", "time")


def ask(sweep, *arguments):
    answer = subprocess.run([sweep, "--quiet", *arguments], capture_output=True, text=True)
    return answer.returncode, answer.stdout


def cases_of(folder):
    with open(folder / "cases.csv", newline="") as file:
        rows = csv.DictReader(file)
        return {"|".join(row[key] for key in ("scene", "norm", "n", "steps")): [row["status"], row["error"], row["floor"]]
                for row in rows}


def verdicts_of(folder):
    verdicts = json.loads((folder / "verdict.json").read_text())["verdicts"]
    return {"|".join(str(v[key]) for key in ("scene", "norm", "variable", "predicted")): v["verdict"] for v in verdicts}


def answers(sweep):
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        found["exit"], _ = ask(sweep, "run", "--all", "--out", str(folder))
        found["cases"], found["verdicts"] = cases_of(folder), verdicts_of(folder)
        for study, options in STUDIES.items():
            for scene in STUDIED:
                print(time.strftime("%T"), study, scene, file=sys.stderr)
                code, text = ask(sweep, study, scene, "--json", *options)
                found[f"{study} {scene}"] = [code, json.loads(text) if text.strip() else None]
        code, text = ask(sweep, "extremes", "--json", "--out", str(folder / "extremes"))
        found["extremes"] = [code, json.loads(text)]
    return found


def number(text):
    return float(text) if text else math.nan


def cases_differ(old, new):
    for key in sorted(old.keys() & new.keys()):
        (status, error, floor), (status_now, error_now, _) = old[key], new[key]
        before, now = number(error), number(error_now)
        allowed = max(1e-10 * abs(before), number(floor) if floor else 0.0)
        same = status == status_now and (before == now or abs(before - now) <= allowed or math.isnan(before) and math.isnan(now))
        if not same:
            yield f"{key}: {status} {error} -> {status_now} {error_now} (floor {floor})"


def values_differ(old, new, place):
    if isinstance(old, dict) and isinstance(new, dict):
        for key in old.keys() & new.keys():
            if not any(word in key for word in LEFT_OUT):
                yield from values_differ(old[key], new[key], f"{place}.{key}")
    elif isinstance(old, list) and isinstance(new, list):
        if len(old) != len(new):
            yield f"{place}: {len(old)} entries -> {len(new)}"
        for at, (a, b) in enumerate(zip(old, new)):
            yield from values_differ(a, b, f"{place}[{at}]")
    elif isinstance(old, float) or isinstance(new, float):
        close = isinstance(old, (int, float)) and isinstance(new, (int, float)) and math.isclose(old, new, rel_tol=1e-6, abs_tol=1e-9)
        if not close:
            yield f"{place}: {old} -> {new}"
    elif old != new:
        yield f"{place}: {old!r} -> {new!r}"


def differences(old, new):
    for part in ("cases", "verdicts"):
        gone, added = old[part].keys() - new[part].keys(), new[part].keys() - old[part].keys()
        for what, keys in (("gone", gone), ("new", added)):
            scenes = sorted({key.split("|")[0] for key in keys})
            if scenes:
                print(f"{part} {what}: {len(keys)} of {', '.join(scenes)}")
    yield from cases_differ(old["cases"], new["cases"])
    for part in sorted(old.keys() - {"cases"}):
        if part in new:
            yield from values_differ(old[part], new[part], part)


def main():
    what, sweep, *rest = sys.argv[1:]
    path = pathlib.Path(rest[0] if rest else "tests/frozen") / "answers.json.gz"
    now = answers(sweep)
    if what == "record":
        path.parent.mkdir(parents=True, exist_ok=True)
        buffer = io.BytesIO()
        with gzip.GzipFile(fileobj=buffer, mode="wb", mtime=0) as file:
            file.write(json.dumps(now, sort_keys=True).encode())
        path.write_bytes(buffer.getvalue())
        return
    old = json.loads(gzip.decompress(path.read_bytes()))
    found = list(differences(old, now))
    print("\n".join(found))
    print(f"{len(old['cases'])} cases, {len(old['verdicts'])} verdicts, {len(old) - 3} studies: {len(found)} differences")
    sys.exit(1 if found else 0)


main()
