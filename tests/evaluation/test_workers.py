"""Whoever does the work, however it is stopped: the same bytes."""

import multiprocessing
import os
import signal
import socket
import subprocess
import sys
import time

import pytest

from palms.errors import InputError, PalmsError
from palms.evaluation import workers
from palms.evaluation.experiment import BATCH
from palms.evaluation.journal import Journal
from palms.evaluation.workers import run_experiment
from tests.evaluation.conftest import run_into

DIES = """
import os, signal, sys
from pathlib import Path
from tests.evaluation.conftest import run_into, small
if __name__ == "__main__":
    die = lambda _n: os.kill(os.getpid(), signal.SIGKILL)
    run_into(Path(sys.argv[1]), small(), jobs=int(sys.argv[2]), progress=die)
"""  # as soon as the first trials have arrived, while the workers are at the next


def test_two_processes_give_the_same_bytes(experiment, expected, tmp_path):
    counted = []
    assert run_into(tmp_path / "r", experiment, jobs=2, progress=counted.append) == expected
    assert sum(counted) == 40


def start(folder, jobs):
    """Run the experiment in a process that dies; it leads a group of its own."""
    return subprocess.Popen(
        [sys.executable, "-c", DIES, str(folder), str(jobs)], start_new_session=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip


def lines_of(folder):
    path = folder / "trials.jsonl"
    return path.read_bytes().count(b"\n") if path.exists() else 0


def wait_for(condition, seconds=60.0):
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.01)


def nobody_left(group):
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return True
    return False


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_killed_run_goes_on_and_its_workers_end(experiment, expected, tmp_path):
    folder = tmp_path / "r"
    process = start(folder, 2)
    try:
        assert process.wait() == -signal.SIGKILL
        saved = lines_of(folder)
        wait_for(lambda: nobody_left(process.pid))
    finally:
        if not nobody_left(process.pid):
            os.killpg(process.pid, signal.SIGKILL)
    assert BATCH <= saved < 40
    counted = []
    assert run_into(folder, experiment, progress=counted.append) == expected
    assert sum(counted) == 40 - saved


def test_nothing_but_the_trials_in_flight_is_lost(experiment, expected, tmp_path):
    def stop(_n):
        raise KeyboardInterrupt

    for arrived in (1, 2):
        with pytest.raises(KeyboardInterrupt):
            run_into(tmp_path, experiment, progress=stop)
        assert lines_of(tmp_path) == arrived * BATCH
    assert run_into(tmp_path, experiment) == expected


def test_a_dead_worker_is_said_and_the_rest_goes_on(experiment, expected, tmp_path):
    def kill_one(_n):
        multiprocessing.active_children()[0].kill()

    with pytest.raises(PalmsError, match="a worker process died; run the same command again"):
        run_into(tmp_path, experiment, jobs=2, progress=kill_one)
    assert lines_of(tmp_path) >= BATCH
    assert run_into(tmp_path, experiment) == expected


def test_an_error_ends_the_workers_and_arrives_as_it_is(experiment, tmp_path):
    def broken(_n):
        raise InputError("scan", expected="walls", got="none")

    with pytest.raises(InputError, match="scan: expected walls"):
        run_into(tmp_path, experiment, jobs=2, progress=broken)
    wait_for(lambda: not multiprocessing.active_children(), 10.0)


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed", reason="needs the extra cluster")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None,
        host="127.0.0.1",
    ) as cluster:  # fmt: skip
        yield cluster


@pytest.mark.filterwarnings("ignore")
def test_a_cluster_gives_the_same_bytes(cluster, experiment, expected, tmp_path):
    found = run_into(tmp_path / "r", experiment, cluster=cluster.scheduler_address)
    assert found == expected


@pytest.mark.filterwarnings("ignore")
def test_a_worker_of_the_cluster_may_die(cluster, experiment, expected, tmp_path):
    killed = []

    def kill_one(_n):
        if not killed:
            killed.append(next(iter(cluster.workers.values())).process.pid)
            os.kill(killed[0], signal.SIGKILL)

    address = cluster.scheduler_address
    assert run_into(tmp_path / "r", experiment, cluster=address, progress=kill_one) == expected
    assert killed


@pytest.mark.filterwarnings("ignore")
def test_no_scheduler_is_one_line(experiment, tmp_path, monkeypatch):
    pytest.importorskip("distributed", reason="needs the extra cluster")
    monkeypatch.setattr(workers, "CONNECT", "1s")
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{unused.getsockname()[1]}"
    with pytest.raises(InputError, match="expected a running scheduler"):
        run_into(tmp_path, experiment, cluster=address)


def test_without_the_extra_it_is_said(experiment, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    journal = Journal(tmp_path, experiment.to_json(experiment.cases()))
    with pytest.raises(InputError, match="expected the package distributed, got none"):
        run_experiment(experiment, journal, cluster="tcp://127.0.0.1:8786")
