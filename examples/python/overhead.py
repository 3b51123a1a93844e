"""What the judging adds to a solver in process: `verify` against its solves alone, in seconds.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python overhead.py
"""

import time

import gronwall
from viscoelastic import solve


def shortest(run, clock):
    """The least time of five runs."""
    times = []
    for _ in range(5):
        begin = clock()
        run()
        times.append(clock() - begin)
    return min(times)


clocks = {"wall": time.perf_counter, "both processors": time.process_time}
for grid in {}, {"n": [16, 32, 64, 128], "steps": [32]}:
    cases = []
    gronwall.verify("viscoelastic", lambda case: cases.append(case) or solve(case), **grid)
    for name, clock in clocks.items():
        alone = shortest(lambda: [solve(case) for case in cases], clock)
        judged = shortest(lambda: gronwall.verify("viscoelastic", solve, **grid), clock)
        share = 100 * (judged / alone - 1)
        print(f"{grid or 'the grid of the scene'}, {name}: {share:.1f} % of {alone:.2f} s")
