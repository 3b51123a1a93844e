"""What the judging adds to a solver in process: CPU seconds of `verify` outside `solve` over those within.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python overhead.py
"""

import time

import gronwall
from viscoelastic import solve


def share(scene, **grid):
    within = 0.0

    def timed(case):
        nonlocal within
        begin = time.thread_time()
        found = solve(case)
        within += time.thread_time() - begin
        return found

    begin = time.process_time()
    gronwall.verify(scene, timed, **grid)
    return (time.process_time() - begin - within) / within, within


for grid in {}, {"n": [16, 32, 64, 128], "steps": [32]}:
    found, seconds = min(share("viscoelastic", **grid) for _ in range(3))
    print(f"{grid or 'the grid of the scene'}: {100 * found:.1f} % of {seconds:.2f} s")
