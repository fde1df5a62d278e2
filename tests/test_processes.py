"""Several processes that work for this one."""

import os
import subprocess
import sys

import numpy as np
import pytest

from palms.errors import PalmsError
from palms.geometry import as_readonly
from palms.processes import in_order, in_processes


def writeable(array):
    return array.flags.writeable


def test_an_error_in_a_worker_arrives_with_its_story():
    with pytest.raises(ZeroDivisionError) as caught:
        list(in_processes(divmod, iter([(7, 2), (1, 0)]), 1, "run it again"))
    assert "_outcome" in caught.value.__notes__[0]


def test_a_worker_that_leaves_is_said():
    with pytest.raises(PalmsError, match="a worker process died; run it again"):
        list(in_processes(os._exit, iter([(3,), (3,)]), 2, "run it again"))


def test_what_nobody_may_write_to_stays_so_on_its_way():
    arrays = [(as_readonly([1.0, 2.0]),), (np.ones(2),)]
    assert list(in_processes(writeable, iter(arrays), 1, "run it again")) == [False, True]


def test_what_is_numbered_comes_in_order_and_as_soon_as_it_can():
    taken = []

    def arriving():
        for number in (2, 0, 1, 3):
            taken.append(number)
            yield number, -number

    found = in_order(arriving())
    assert next(found) == 0
    assert taken == [2, 0]
    assert list(found) == [-1, -2, -3]


SCRIPT = """
from palms.processes import in_processes
print(sorted(in_processes(pow, iter([(2, 3), (3, 2), (4, 1)]), 2, "run it again")))
"""


def test_a_script_without_a_guard_runs_once(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, timeout=120, check=False
    )
    assert (done.stdout, done.stderr) == ("[4, 8, 9]\n", "")
