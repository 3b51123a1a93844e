#!/usr/bin/env python3
"""Plan, merge and judge of sweeps with many cases that nobody ran: seconds and peak memory of each process.

The plan is made by `sweep plan`; records are written here, with errors C h (1 + k^2), in parts as the plan's jobs would
leave them. Two shapes: scenes of 1,000 cases each (10 meshes, 100 time grids), and all cases in one scene.
usage: benches/beyond.py SWEEP [CASES ...]
"""

import csv
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

BASE = Path("manufactured/signorini.toml")
WORK = Path("target/bench-beyond")
MESHES, STEPS = range(4, 44, 4), range(1, 101)
A_SCENE = len(MESHES) * len(STEPS)


def measured(what, command):
    """Runs a command; its wall and CPU seconds, and its peak resident size."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    out = process.stdout.read()
    err = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    wall = time.perf_counter() - start
    cpu = usage.ru_utime + usage.ru_stime
    print(f"{what:<28} {wall:8.2f} s wall {cpu:8.2f} s CPU {usage.ru_maxrss / 1024:8.0f} MB", flush=True)
    return process.returncode, out.decode(), err.decode()


def scene(folder, name, judged=True):
    """A copy of the base under another name."""
    text = BASE.read_text().replace('name = "signorini"', f'name = "{name}"')
    assert f'name = "{name}"' in text
    if not judged:
        text = text.replace("[scene]\n", "[scene]\njudge = false\n")
    (folder / f"{name}.toml").write_text(text)


def listed(values):
    return ",".join(map(str, values))


def template(sweep, folder, name):
    """The row of each norm of a real case, and what a real part says of itself."""
    out = WORK / "real"
    shutil.rmtree(out, ignore_errors=True)
    subprocess.run(
        [sweep, "--scenes", folder, "run", name, "--n", "4", "--steps", "4", "--out", out],
        capture_output=True,
    )
    with open(out / "cases.csv") as table:
        rows = list(csv.DictReader(table))
    provenance = json.loads((out / "provenance.json").read_text())
    return rows, provenance


def checksum(fields):
    """The 64-bit FNV-1a hash of the fields, each ended by a line break."""
    value = 0xCBF29CE484222325
    for byte in "".join(f"{field}\n" for field in fields).encode():
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return f"{value:016x}"


def write_parts(plan, rows, provenance):
    """The parts of a plan, by its jobs."""
    document = json.loads((plan / "plan.json").read_text())
    scenes = {own["name"]: own for own in document["scenes"]}
    columns = list(rows[0])
    place = {column: columns.index(column) for column in columns}
    lasting = [at for at, column in enumerate(columns[:-1]) if not column.startswith("seconds_")]
    rows = [list(row.values()) for row in rows]
    parts = plan / "parts"
    shutil.rmtree(parts, ignore_errors=True)

    def write(job, cases):
        part = parts / str(job)
        part.mkdir(parents=True)
        # A part is sorted.
        cases.sort()
        with open(part / "cases.csv", "w") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(columns)
            for name, n, steps in cases:
                h, k = 1 / n, 1 / steps
                for row in rows:
                    row[place["scene"]], row[place["n"]], row[place["steps"]] = name, n, steps
                    row[place["h"]], row[place["k"]] = repr(h), repr(k)
                    row[place["error"]], row[place["floor"]] = repr(0.1 * h * (1 + k * k)), "1e-15"
                    row[-1] = checksum(str(row[at]) for at in lasting)
                    table.writerow(row)
        own = {name: scenes[name] for name in {case[0] for case in cases}}
        said = dict(provenance, step_sizes={})
        said["scenes"] = {name: one["hash"] for name, one in own.items()}
        said["texts"] = {name: one["text"] for name, one in own.items()}
        (part / "provenance.json").write_text(json.dumps(said))

    with open(plan / "plan.csv") as table:
        job, cases = None, []
        for row in csv.DictReader(table):
            if row["job"] != job and cases:
                write(job, cases)
                cases = []
            job = row["job"]
            cases.append((row["scene"], int(row["n"]), int(row["steps"])))
        write(job, cases)


def many_scenes(sweep, number, judged):
    folder, plan = WORK / "scenes", WORK / "plan"
    for path in (folder, plan):
        shutil.rmtree(path, ignore_errors=True)
    folder.mkdir(parents=True)
    names = [f"s{i:05}" for i in range(number // A_SCENE)]
    for name in names:
        scene(folder, name, judged)
    words = [sweep, "--quiet", "--scenes", folder, "plan", "--out", plan]
    grid = ["--n", listed(MESHES), "--steps", listed(STEPS)]
    code, out, err = measured(f"plan, {number} cases", [*words, *grid])
    assert code == 0, err
    print(out.splitlines()[0])
    write_parts(plan, *template(sweep, folder, names[0]))
    kind = "merge and judge" if judged else "merge alone"
    merge(sweep, plan, number, kind)
    measured(f"one job of {number}", [sweep, "--quiet", "case", "--job", "0", "--plan", plan, "--out", WORK / "job"])
    shutil.rmtree(WORK / "job", ignore_errors=True)


def one_scene(sweep, number):
    """A plan as `sweep plan` would write it; meshes that are not to be run are not analysed for it."""
    folder, plan = WORK / "scenes", WORK / "plan"
    for path in (folder, plan):
        shutil.rmtree(path, ignore_errors=True)
    folder.mkdir(parents=True)
    scene(folder, "s")
    small = ["--n", "4", "--steps", "4", "--out", plan]
    subprocess.run([sweep, "--quiet", "--scenes", folder, "plan", "s", *small], check=True, capture_output=True)
    # Constants are predicted on every mesh of a line, which takes the time of meshes and not that of records.
    meshes = round(number**0.5) // 4
    steps = number // meshes
    document = json.loads((plan / "plan.json").read_text())
    document.update(n=list(range(1, meshes + 1)), steps=list(range(1, steps + 1)), cases=number)
    (plan / "plan.json").write_text(json.dumps(document))
    with open(plan / "plan.csv", "w") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["id", "scene", "n", "steps", "seconds", "bytes", "job"])
        for n in range(meshes, 0, -1):
            for own in range(steps, 0, -1):
                table.writerow([f"s:n{n}:N{own}", "s", n, own, 1.0, 1e6, meshes - n])
    write_parts(plan, *template(sweep, folder, "s"))
    merge(sweep, plan, number, "one scene: merge and judge")


def merge(sweep, plan, number, kind):
    out = plan / "merged"
    code, said, err = measured(f"{kind}, {number}", [sweep, "--quiet", "merge", plan / "parts", "--plan", plan, "--out", out])
    assert f"{number} cases" in said and " 0 missing" in said, said[-2000:] + err
    print(said.splitlines()[-2], f"exit {code},", sum(1 for _ in open(out / "cases.csv")) - 1, "rows")


def main():
    sweep = os.path.abspath(sys.argv[1])
    for number in [int(word) for word in sys.argv[2:]] or [10_000, 1_000_000]:
        many_scenes(sweep, number, judged=False)
        many_scenes(sweep, number, judged=True)
        one_scene(sweep, number)
    shutil.rmtree(WORK)


main()
