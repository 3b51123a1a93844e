"""The scenes punch, elastic-punch and linear-punch in scikit-fem and in this program, in turn, in one run.

    python side_by_side.py PATH-OF-SWEEP [--repeat R] [VARIANT:N:STEPS ...]

Prints CPU seconds of either (minimum of R runs, one thread), peak memory of the processes, the ratios, and the
largest relative difference of the quantities at t = T. scikit-fem's seconds are those of mesh, assembly and steps;
this program's are those of its whole process. Exit code 1 if the two disagree by more than 1e-8.
"""
import json
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
DEFAULT = ["linear-punch:64:64", "elastic-punch:64:64", "punch:32:32"]
PAIRS = {"norm_eps": "strain_norm", "zeta": "zeta", "energy": "elastic_energy",
         "contact_force": "contact_force", "min_uy": "min_uy"}
# Both solve to residuals of 1e-10 or better.
AGREE = 1e-8


def run(command):
    """Output, CPU seconds and peak memory (MB) of a process."""
    child = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    output = child.stdout.read()
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(command)} ended with status {status}")
    return json.loads(output), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def best(command, repeat, seconds):
    """The fastest of some runs, with the largest memory."""
    runs = [run(command) for _ in range(repeat)]
    result, cpu, _ = min(runs, key=lambda r: seconds(r[0], r[1]))
    return result, seconds(result, cpu), max(memory for _, _, memory in runs)


def main():
    sweep, arguments = os.path.abspath(sys.argv[1]), sys.argv[2:]
    repeat = 3
    if "--repeat" in arguments:
        at = arguments.index("--repeat")
        repeat = int(arguments[at + 1])
        del arguments[at:at + 2]
    os.chdir(os.path.join(HERE, "..", ".."))
    print(f"{'scene':14} {'n':>4} {'N':>4} {'scikit-fem':>11} {'sweep':>8} {'ratio':>6} "
          f"{'MB':>5} {'MB':>5} {'difference':>10}")
    worst = 0.0
    for case in arguments or DEFAULT:
        variant, n, steps = case.split(":")
        theirs, slow, large = best(
            [sys.executable, os.path.join(HERE, "scikit_fem_punch.py"), variant, n, steps, "--json"],
            repeat, lambda result, _: result["cpu_seconds"])
        ours, fast, small = best(
            [sweep, "solve", variant, "--n", n, "--steps", steps, "--json"],
            repeat, lambda _, cpu: cpu)
        off = max(abs(theirs[a] - ours[b]) / max(abs(theirs[a]), 1e-3) for a, b in PAIRS.items())
        worst = max(worst, off)
        print(f"{variant:14} {n:>4} {steps:>4} {slow:10.3f}s {fast:7.3f}s {slow / fast:6.1f} "
              f"{large:5.0f} {small:5.0f} {off:10.1e}", flush=True)
    print(f"solver of scikit-fem here: {theirs['solver']}; minimum of {repeat} runs each")
    return 0 if worst <= AGREE else 1


if __name__ == "__main__":
    sys.exit(main())
