"""Phones that walk through the sample building, each over a socket of its own, in one process.

Started by `python -m benchmarks.load`; prints what it measured as JSON.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import random
import re
import time
from dataclasses import dataclass, field

import numpy as np
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from palms.io import open_dataset
from palms.sample import sample_folder

_SEQ = re.compile(r'"seq":(\d+)')


@dataclass
class Report:
    steps_ms: list[float] = field(default_factory=list)
    scans_ms: list[float] = field(default_factory=list)
    started: int = 0
    refused: int = 0
    localized: int = 0
    errors: list[str] = field(default_factory=list)


def inputs(steps_per_s: float, n: int) -> tuple[str, list[tuple[float, list[float]]]]:
    """The sample's scan, and n positions of its walk to and fro, evenly in time."""
    case = open_dataset(sample_folder()).cases[0]
    scan, walk = case.scan(), case.walk().odometry()
    free = [None if np.isnan(r) else r for r in scan.coverage_m.tolist()]
    first = {
        "type": "scan",
        "seq": 1,
        "t_s": 0.0,
        "planes": scan.walls_m.tolist(),
        "coverage_m": free,
    }
    there = [[0.0, 0.0], *walk.position_m.tolist()]
    round_trip = [*there, *there[-2:0:-1]]
    path = [round_trip[i % len(round_trip)] for i in range(n + 1)][1:]
    return json.dumps(first), [((i + 1) / steps_per_s, place) for i, place in enumerate(path)]


async def listen(socket: ClientConnection, sent: dict[int, float], report: Report) -> None:
    """Note when estimates come."""
    stage = ""
    async for text in socket:
        now = time.perf_counter()
        if '"type":"estimate"' in text[:40]:
            seq = int(_SEQ.search(text).group(1))
            if seq in sent:
                took = 1e3 * (now - sent.pop(seq))
                (report.scans_ms if seq == 1 else report.steps_ms).append(took)
            stage = text[text.index('"stage":') + 9 :].partition('"')[0]
        elif '"type":"error"' in text[:40]:
            report.errors.append(text[:200])
        elif '"type":"ended"' in text[:40]:
            report.localized += stage == "localized"
            return


async def phone(url: str, number: int, arguments: argparse.Namespace, report: Report) -> None:
    """One phone from its start to the end of the test."""
    later = random.Random(number).random()  # nobody's steps fall in with all others'
    await asyncio.sleep((number + later) * arguments.start_over / arguments.sessions)
    scan, steps = inputs(arguments.rate, int(arguments.rate * arguments.seconds))
    async with connect(url, compression=None) as socket:
        await socket.send(json.dumps({
            "type": "hello", "building": "sample", "seed": number,
            "receive": ["estimates", "events"],
        }))  # fmt: skip
        answer = json.loads(await socket.recv())
        if answer["type"] != "welcome":
            report.refused += answer.get("code") == "full"
            return
        report.started += 1
        sent: dict[int, float] = {1: time.perf_counter()}
        await socket.send(scan)
        listening = asyncio.create_task(listen(socket, sent, report))
        try:
            await walk(socket, steps, sent, arguments)
            report.errors += ["no answer"] * len(sent)
            await socket.send('{"type": "end"}')
            await listening
        finally:
            listening.cancel()
            await asyncio.gather(listening, return_exceptions=True)


async def walk(
    socket: ClientConnection,
    steps: list[tuple[float, list[float]]],
    sent: dict[int, float],
    arguments: argparse.Namespace,
) -> None:
    """Send step by step, each at its time, until the test is over."""
    began = time.perf_counter()
    for seq, (t_s, place) in enumerate(steps, 2):
        await asyncio.sleep(max(began + t_s - time.perf_counter(), 0))
        if began + t_s > arguments.until:
            break
        sent[seq] = time.perf_counter()
        sample = {"t_s": t_s, "position_m": place}
        await socket.send(json.dumps({"type": "odometry", "seq": seq, "samples": [sample]}))
    await asyncio.sleep(1.0)


async def run(arguments: argparse.Namespace) -> Report:
    report = Report()
    arguments.until = time.perf_counter() + arguments.seconds
    phones = [
        phone(arguments.url, number, arguments, report)
        for number in range(arguments.sessions + arguments.too_many)
    ]
    for error in await asyncio.gather(*phones, return_exceptions=True):
        if isinstance(error, ConnectionClosed | OSError | AssertionError):
            report.errors.append(repr(error)[:200])
        elif error is not None:
            raise error
    return report


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("url")
    parser.add_argument("--sessions", type=int, required=True)
    parser.add_argument("--too-many", type=int, required=True)
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--start-over", type=float, required=True)
    parser.add_argument("--rate", type=float, required=True)
    report = asyncio.run(run(parser.parse_args()))
    print(json.dumps(report.__dict__))


if __name__ == "__main__":
    main()
