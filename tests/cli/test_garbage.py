"""Garbage is collected rarely in a command, and as usual in one that stays."""

import subprocess
import sys

import pytest

SETUP = """
import atexit, gc
usual = gc.get_threshold()
collections = []
gc.callbacks.append(lambda phase, info: collections.append(info["generation"]))
from palms.cli._garbage import collect_as_usual, collect_rarely
"""


def run(code):
    done = subprocess.run(
        [sys.executable, "-c", SETUP + code], capture_output=True, text=True, check=True
    )
    return done.stdout.splitlines()


def test_a_command_does_not_look_through_what_it_keeps():
    code = """
collect_rarely()
del collections[:]
kept = [[i] for i in range(100_000)]
print(collections)
"""
    assert run(code) == ["[]"]


def test_garbage_is_collected_all_the_same_when_it_is_much():
    code = """
class Loop:
    def __init__(self):
        self.self = self
    alive = 0
    def __del__(self):
        Loop.alive -= 1
collect_rarely()
most = 0
for _ in range(1_000_000):
    Loop.alive += 1
    Loop()
    most = max(most, Loop.alive)
print(100_000 < most < 500_000)
"""
    assert run(code) == ["True"]


def test_nothing_is_looked_through_once_more_when_the_process_ends():
    code = """
atexit.register(lambda: print(gc.get_freeze_count() > 100_000))  # after what is registered later
collect_rarely()
kept = [[i] for i in range(100_000)]
"""
    assert run(code) == ["True"]


@pytest.mark.parametrize("first", ["", "collect_rarely()"])
def test_who_stays_collects_as_usual_but_not_what_was_there(first):
    code = f"""
{first}
kept = [[i] for i in range(50_000)]
collect_as_usual()
print(gc.get_threshold() == usual, gc.get_freeze_count() > 50_000)
del collections[:]
more = [[i] for i in range(50_000)]
print(len(collections) > 10)
"""
    assert run(code) == ["True True", "True"]


def test_commands_collect_rarely():
    code = """
import sys
from palms.cli import main
sys.argv = ["palms", "--version"]
try:
    main()
except SystemExit:
    print(gc.get_threshold()[0] > 100 * usual[0], file=sys.stderr)
"""
    done = subprocess.run(
        [sys.executable, "-c", SETUP + code], capture_output=True, text=True, check=True
    )
    assert done.stderr.split() == ["True"]
