"""`python -m benchmarks.load`: does the server keep up with a hundred phones?

A server process, and a process with all the phones, over the loopback. Each phone walks through the
sample building with the default method; what counts is the time from a step to its estimate. Some
more phones than the server takes come along, to be refused.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

from benchmarks.harness import machine_words
from benchmarks.page import put


def serve(folder: str, sessions: int) -> tuple[subprocess.Popen[str], str]:
    command = [sys.executable, "-m", "palms", "serve", "--port", "0", "--data", folder]
    limits = [f"sessions={sessions}", "sockets=2000", "requests_per_s=100", "request_burst=1000"]
    for limit in limits:
        command += ["--limit", limit]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    found = re.search(r"http://([\w.:]+)", server.stdout.readline())
    assert found, "the server did not start"
    return server, f"ws://{found.group(1)}/api/v1/live"


class Memory(threading.Thread):
    """Resident memory of a process, noted every second."""

    def __init__(self, pid: int) -> None:
        super().__init__(daemon=True)
        self.status = Path("/proc") / str(pid) / "status"
        self.mb: list[float] = []
        self.over = threading.Event()

    def run(self) -> None:
        while not self.over.wait(1.0):
            found = re.search(r"VmRSS:\s+(\d+) kB", self.status.read_text())
            self.mb.append(int(found.group(1)) / 1024 if found else float("nan"))


def cpu_s(pid: int) -> float:
    fields = (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / 100


def rows(
    report: dict, arguments: argparse.Namespace, memory: Memory, busy_s: float, took_s: float
) -> list[tuple]:
    steps, scans = np.array(report["steps_ms"]), np.array(report["scans_ms"])
    settled = memory.mb[int(arguments.start_over) + 5 :] or memory.mb
    third = max(len(settled) // 3, 1)
    return [
        ("sessions, and seconds", f"{report['started']}, {arguments.seconds:g}"),
        ("steps", f"{len(steps)}"),
        ("step to estimate, median", f"{np.median(steps):.1f} ms"),
        ("step to estimate, 95 %", f"{np.quantile(steps, 0.95):.1f} ms"),
        ("step to estimate, 99 %", f"{np.quantile(steps, 0.99):.1f} ms"),
        ("step to estimate, slowest", f"{steps.max():.0f} ms"),
        ("scan to estimate, median and slowest", f"{np.median(scans):.0f}, {scans.max():.0f} ms"),
        ("errors", f"{len(report['errors'])}"),
        ("localized in the end", f"{report['localized']}"),
        ("refused beyond the limit", f"{report['refused']} of {arguments.too_many}"),
        ("server's memory once all are there: first third, last third",
         f"{np.mean(settled[:third]):.0f}, {np.mean(settled[-third:]):.0f} MB"),
        ("server's share of one core", f"{100 * busy_s / took_s:.0f} %"),
        ("server's work for a step, scans included", f"{1e3 * busy_s / len(steps):.2f} ms"),
    ]  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.load", description=__doc__)
    parser.add_argument("--sessions", type=int, default=100)
    parser.add_argument("--too-many", type=int, default=10, help="phones that come to be refused")
    parser.add_argument("--seconds", type=float, default=300.0)
    parser.add_argument(
        "--start-over", type=float, default=100.0, help="seconds until all are there"
    )
    parser.add_argument("--rate", type=float, default=2.0, help="steps a second of each phone")
    parser.add_argument("--results", type=Path, help="put the table into this page")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="palms-load-") as folder:
        server, url = serve(folder, arguments.sessions)
        time.sleep(5.0)  # its loops get ready
        memory = Memory(server.pid)
        memory.start()
        began, used = time.perf_counter(), cpu_s(server.pid)
        command = [sys.executable, "-m", "benchmarks.load.phones", url]
        for name in ("sessions", "too_many", "seconds", "start_over", "rate"):
            command += [f"--{name.replace('_', '-')}", str(getattr(arguments, name))]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
        busy_s, took_s = cpu_s(server.pid) - used, time.perf_counter() - began
        memory.over.set()
        server.terminate()
        server.wait()
    report = json.loads(done.stdout)
    lines = [
        "| | |",
        "|---|---|",
        *(f"| {a} | {b} |" for a, b in rows(report, arguments, memory, busy_s, took_s)),
    ]
    text = "\n".join(lines)
    print(text)
    for error in report["errors"][:5]:
        print(error, file=sys.stderr)
    if arguments.results:
        put("load", f"{text}\n\n{machine_words()}", arguments.results)


if __name__ == "__main__":
    main()
