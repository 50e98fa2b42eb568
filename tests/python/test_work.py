"""Work that is watched, ended and shared: callbacks, Ctrl-C, threads."""

import os
import signal
import subprocess
import sys
import threading
import time

import extremal as ex
import numpy as np
import pytest


def interrupt_soon(seconds=0.3):
    """Ctrl-C for this process, while the main thread is at work."""
    timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    return timer


def test_progress(arc):
    steps = []
    s = arc.solve(progress=steps.append)
    assert len(steps) == s.iterations and steps[-1].residual < 1e-6
    assert steps[0].elements > 0 and steps[0].degree > 0 and steps[0].damping <= 1


def test_an_exception_of_the_callback_ends_the_solve(arc):
    def stop(step):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        arc.solve(progress=stop)
    assert arc.solve().converged


def test_ctrl_c_ends_a_solve(long_solve):
    begin = time.monotonic()
    timer = interrupt_soon()
    with pytest.raises(KeyboardInterrupt):
        long_solve.solve()
    timer.join()
    assert time.monotonic() - begin < 5


def test_ctrl_c_ends_many(arc):
    begin = time.monotonic()
    timer = interrupt_soon()
    with pytest.raises(KeyboardInterrupt):
        arc.solve_many(duration=np.full(300_000, 2.5), tolerance=1e-12)
    timer.join()
    assert time.monotonic() - begin < 5
    assert arc.solve_many(duration=[2.5]).converged.all()


def test_threads_solve_one_problem_at_once(arc):
    expected = [arc.solve(tolerance=10.0**-k).action for k in range(4, 12)]
    results = {}

    def work(name):
        results[name] = [arc.solve(tolerance=10.0**-k).action for k in range(4, 12) for _ in range(20)][
            ::20
        ]

    workers = [threading.Thread(target=work, args=(name,)) for name in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert all(results[name] == expected for name in range(4))


def test_other_threads_run_meanwhile(arc):
    """The lock is given up: Python counts while a long solve is at work."""
    counted = 0
    done = threading.Event()

    def work():
        arc.solve_many(duration=np.full(4000, 2.5), tolerance=1e-12, threads=1)
        done.set()

    worker = threading.Thread(target=work)
    worker.start()
    while not done.is_set():
        counted += 1
        time.sleep(0.001)
    worker.join()
    assert counted > 5


def test_ctrl_c_in_a_script(tmp_path, long_solve):
    """A script ends by the signal as any script of Python does."""
    (tmp_path / "scene.toml").write_text(long_solve.to_toml())
    script = (
        f"import extremal as ex; p = ex.load({str(tmp_path / 'scene.toml')!r}); "
        "print('ready', flush=True); p.solve()"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=20)
    assert process.returncode in (-signal.SIGINT, 130) and "KeyboardInterrupt" in error


def test_overhead_of_a_solve(arc):
    """What a call costs beside the solver. The least of several is far above what is documented, for
    machines that are at work."""
    arc.solve()
    overheads = []
    for _ in range(300):
        begin = time.perf_counter()
        s = arc.solve()
        overheads.append(time.perf_counter() - begin - s.seconds["solve"] - s.seconds["analyse"])
    assert min(overheads) < 100e-6
