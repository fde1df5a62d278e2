"""A server on a free port, in a thread of this process; and a phone that talks to it."""

from __future__ import annotations

import contextlib
import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import httpx
import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from palms.floorplan import Room
from palms.io import open_dataset
from palms.sample import sample_folder
from palms.server import messages
from palms.server.application import Setup
from palms.server.gate import Gate
from palms.server.limits import Limits
from palms.server.plans import plan_text
from palms.server.running import in_background
from palms.server.store import BuildingRow, Store
from tests.worlds import seen_from, two_rooms

PATIENCE_S = 90  # so long may a machine that is busy take
http = SimpleNamespace(
    **{
        name: partial(getattr(httpx, name), timeout=PATIENCE_S)
        for name in ("get", "post", "delete")
    }
)
START = np.array([2.0, 2.0])
DRIFT = 0.4
STEPS = [*[[0.3, 0.0]] * 4, *[[0.0, 0.3]] * 5, *[[-0.3, 0.0]] * 4]


def hall():
    """A building that is quickly rasterised."""
    study = Room("Study", [[0, 0], [8, 0], [8, 5], [0, 5]])
    return replace(two_rooms(), rooms=(study,), level="1")


def new_store(folder: Path) -> Path:
    """A store that holds that building, instead of the sample."""
    store = Store(folder)
    store.add_building(BuildingRow("hall", "Hall", (("1", plan_text(hall())),)), 0.0)
    store.close()
    return folder


def scan_walls():
    near = np.linalg.norm(hall().segments_m.mean(axis=1) - START, axis=1) < 5
    return seen_from(START, hall().segments_m[near], DRIFT).walls_m.tolist()


def positions():
    """Of the phone while it walks, odom frame."""
    c, s = np.cos(-DRIFT), np.sin(-DRIFT)
    return np.cumsum(np.array(STEPS) @ np.array([[c, s], [-s, c]]), axis=0).tolist()


def scan(seq=1, t_s=100.0):
    return {"type": "scan", "seq": seq, "t_s": t_s, "planes": scan_walls()}


def odometry(seq, place, t_s=None):
    t_s = 100.0 + 0.5 * seq if t_s is None else t_s
    return {"type": "odometry", "seq": seq, "samples": [{"t_s": t_s, "position_m": place}]}


def whole_walk():
    return [scan(), *(odometry(seq, place) for seq, place in enumerate(positions(), 2))]


class Phone:
    """A socket that speaks JSON; what comes is kept by its type."""

    def __init__(self, url, **kwargs):
        self.opened = connect(
            "ws" + url.removeprefix("http") + "/api/v1/live",
            compression=None,
            open_timeout=PATIENCE_S,
            **kwargs,
        )
        self.socket = self.opened.__enter__()
        self.frames = []

    def say(self, message):
        self.socket.send(message if isinstance(message, str) else json.dumps(message))

    def next(self, timeout=PATIENCE_S):
        content = self.socket.recv(timeout)
        if isinstance(content, bytes):
            self.frames.append(messages.unpack_frame(content))
            return {"type": "frame"}
        messages.parse_answer(content)
        return json.loads(content)

    def until(self, kind, **fields):
        """The next message of a type with these fields."""
        while True:
            answer = self.next()
            if answer["type"] == kind and all(answer[k] == v for k, v in fields.items()):
                return answer

    def hello(self, **fields):
        self.say({"type": "hello", "building": "hall", "seed": 1, "particles": 500} | fields)
        return self.next()

    def walk(self, inputs):
        """Send inputs; return the last estimate."""
        for message in inputs:
            self.say(message)
        return self.until("estimate", seq=inputs[-1]["seq"])

    def rest(self):
        """All that still comes until the socket closes, and its code."""
        found = []
        try:
            while True:
                found.append(self.next())
        except ConnectionClosed as closed:
            return found, closed.rcvd.code if closed.rcvd else None

    def close(self):
        self.socket.close()


@pytest.fixture
def phones():
    """Make phones; they are closed in the end."""
    with contextlib.ExitStack() as stack:

        def make(url, **kwargs):
            phone = Phone(url, **kwargs)
            stack.callback(phone.close)
            return phone

        yield make


@pytest.fixture
def serve(tmp_path):
    """Start servers; they are stopped in the end."""
    with contextlib.ExitStack() as stack:

        def start(limits=None, token=None, folder=None, **options):
            folder = folder or tmp_path / "data"
            if not folder.exists():
                new_store(folder)
            setup = Setup(
                folder, Gate(token, options.pop("hosts", ())), limits or Limits(),
                inline_uploads=options.pop("inline_uploads", True), **options,
            )  # fmt: skip
            running = in_background(setup)
            return stack.enter_context(running)

        yield start


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """A server that the tests of a module share."""
    folder = new_store(tmp_path_factory.mktemp("server") / "data")
    limits = Limits(requests_per_s=1e6, request_burst=10**6)
    with in_background(Setup(folder, limits=limits, inline_uploads=True)) as url:
        yield url


@pytest.fixture
def rest(server):
    with httpx.Client(base_url=server, timeout=60) as client:
        yield client


@pytest.fixture(scope="session")
def sample():
    return open_dataset(sample_folder()).cases[0]
