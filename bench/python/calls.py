"""What bench_python asks of the module: seconds of one call of solve(), and of solve_many() with one thread.

python calls.py SCENE CALLS ARCS
"""

import json
import sys
import time

import extremal as ex
import numpy as np

scene, calls, arcs = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
problem = ex.load(scene)
solutions = [problem.solve() for _ in range(20)]

begin = time.perf_counter()
for _ in range(calls):
    solution = problem.solve()
one = (time.perf_counter() - begin) / calls

angle = np.linspace(0.5, 2.5, arcs)
ends = np.c_[np.cos(angle), np.sin(angle)]
problem.solve_many(end=ends[:20], threads=1)
begin = time.perf_counter()
many = problem.solve_many(end=ends, threads=1)
seconds = time.perf_counter() - begin

print(
    json.dumps(
        {
            "one": one,
            "action": solution.action,
            "many": seconds,
            "converged": int(many.converged.sum()),
            "actions": float(many.action.sum()),
        }
    )
)
