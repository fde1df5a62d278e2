"""The commands as a user runs them: in a process of their own, on the sample building."""

from __future__ import annotations

import base64
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from palms.io import open_dataset
from palms.sample import sample_folder

COMMAND = [sys.executable, "-m", "palms"]
CASE = open_dataset(sample_folder()).cases[0]
PLAN, SCAN, WALK = (str(p) for p in (CASE.plan_path, CASE.scan_paths[0], CASE.walk_path))


def palms(*arguments, cwd=None, **more):
    return subprocess.run(
        [*COMMAND, *map(str, arguments)],
        cwd=cwd, capture_output=True, text=True, timeout=120, check=False, **more,
    )  # fmt: skip


def children_s():
    """What ended processes of this one took of the processors; a busy machine changes little."""
    times = os.times()
    return times.children_user + times.children_system


def check_failure(result, says=""):
    assert result.returncode == 1, result
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert result.stderr.startswith("palms: error: ")
    assert "Traceback" not in result.stderr
    assert says in result.stderr


@pytest.fixture(scope="session")
def demo(tmp_path_factory):
    """The demo, run once; the loops may have to be compiled."""
    folder = tmp_path_factory.mktemp("demo")
    start = children_s()
    result = palms("demo", "--json", "demo.json", cwd=folder)
    return SimpleNamespace(result=result, folder=folder, seconds=children_s() - start)


@pytest.fixture(scope="session")
def track(tmp_path_factory):
    """Two trials of the sample's walk, as JSON in a file."""
    path = tmp_path_factory.mktemp("track") / "track.json"
    result = palms("track", PLAN, SCAN, WALK, "--trials", 2, "--json", path)
    return SimpleNamespace(result=result, document=json.loads(path.read_text()))


def test_demo_says_where_how_sure_and_how_far_off(demo):
    assert demo.result.returncode == 0, demo.result
    assert re.search(r"Localized after \d+ m \(\d+ s\): \w+", demo.result.stdout)
    assert re.search(r"(corridor|Room|Lab|Lobby)", demo.result.stdout)
    assert re.search(r"within [\d.]+ m with \d+ %", demo.result.stdout)
    assert re.search(r"The truth was [\d.]+ m away", demo.result.stdout)
    assert demo.seconds < 60  # 20 on a quiet machine; this one runs the tests as well


def test_demo_ends_at_the_right_place(demo):
    document = json.loads((demo.folder / "demo.json").read_text())
    steps = document["trials"][0]["steps"]
    answer = steps["x_m"][-1], steps["y_m"][-1]
    assert np.linalg.norm(answer - CASE.walk().reference_m[-1]) < 2.0
    assert steps["stage"][-1] == "localized"


def test_demo_draws_a_report_that_needs_nothing_else(demo):
    folder = demo.folder / "palms-demo"
    report = (folder / "report.html").read_text()
    assert not re.findall(r'(?:src|href)="(?!data:|#)[^"]*"', report)
    assert "data:image/" in report
    pictures = [path for path in folder.iterdir() if path.suffix == ".png"]
    assert pictures
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in pictures)
    assert any(path.suffix in (".gif", ".webp") for path in folder.iterdir())
    for image in re.findall(r'"data:image/[a-z]+;base64,([^"]+)"', report):
        base64.b64decode(image, validate=True)


def test_demo_in_a_pipe_is_plain_text(demo):
    assert "\x1b" not in demo.result.stdout + demo.result.stderr


def test_track_writes_what_it_says(track):
    assert track.result.returncode == 0, track.result
    document = track.document
    assert document["schema"] == "palms-track/1"
    assert [trial["seed"] for trial in document["trials"]] == [0, 1]
    intervals = json.loads(Path(WALK).read_text())["time_intervals"]
    for trial in document["trials"]:
        assert trial["steps"]["t_s"] == pytest.approx(np.cumsum(intervals))
        assert {len(values) for values in trial["steps"].values()} == {len(intervals)}


def test_a_trial_is_a_run_of_its_own(track):
    result = palms("track", PLAN, SCAN, WALK, "--seed", 1, "--json", "-")
    assert json.loads(result.stdout)["trials"] == track.document["trials"][1:]


def test_demo_is_the_first_trial(demo, track):
    document = json.loads((demo.folder / "demo.json").read_text())
    assert document["trials"] == track.document["trials"][:1]


def test_track_draws_into_a_folder(tmp_path):
    result = palms("track", PLAN, SCAN, WALK, "--out", tmp_path / "a" / "b")
    assert result.returncode == 0, result
    assert (tmp_path / "a" / "b" / "pipeline.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "a" / "b" / "report.html").read_text().startswith("<!DOCTYPE html>")


def test_locate_as_table_json_and_picture(tmp_path):
    result = palms("locate", PLAN, SCAN, "--top", 3, "--json", "-", "--png", tmp_path / "a.png")
    assert result.returncode == 0, result
    candidates = json.loads(result.stdout)["candidates"]
    assert len(candidates) == 3
    assert all(each["room"] for each in candidates)
    assert "probability" in result.stderr
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    "arguments", [("plan", "info", PLAN), ("scan", "info", SCAN), ("walk", "info", WALK)]
)
def test_info(arguments):
    result = palms(*arguments)
    assert result.returncode == 0, result
    assert result.stdout.count("\n") >= 4


def test_help_is_light():
    code = "import sys, palms.cli.app; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert not {"numpy", "numba", "scipy", "matplotlib", "pydantic", "shapely"} & set(loaded)


def test_following_loads_only_what_it_needs():
    code = """
import sys
from palms.cli import main
try:
    main()
finally:
    from palms._compiled import observation as loops
    found = vars(loops).items()
    several = [name for name, each in found if len(getattr(each, "signatures", ())) > 1]
    print(*sys.modules, "kinds:", *several)
"""
    done = subprocess.run(
        [sys.executable, "-c", code, "track", PLAN, SCAN, WALK, "--json", os.devnull],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    modules, _, several = done.stdout.splitlines()[-1].partition("kinds:")
    loaded = set(modules.split())
    assert {"numba", "scipy.fft"} <= loaded
    others = {"PIL", "matplotlib", "rich", "scipy.ndimage", "scipy.sparse", "scipy.spatial"}
    readers = {"palms.io.plan_geojson", "palms.io.plan_osm", "palms.io.android"}
    assert not (others | readers) & loaded
    assert not several.split()  # no loop is loaded for two kinds of the same array


def test_help_is_quick():
    def seconds():
        start = children_s()
        assert palms("--help").returncode == 0
        return children_s() - start

    assert min(seconds() for _ in range(3)) < 1.0  # 0.3 on a quiet machine


DAMAGES = {
    "missing plan": ("no-such-file.csv", SCAN, WALK),
    "scan for a plan": (SCAN, SCAN, WALK),
    "walk for a scan": (PLAN, WALK, WALK),
    "plan for a walk": (PLAN, SCAN, PLAN),
    "unknown method": (PLAN, SCAN, WALK, "--method", "magic"),
    "output below a file": (PLAN, SCAN, WALK, "--json", f"{PLAN}/track.json"),
    "folder below a file": (PLAN, SCAN, WALK, "--out", f"{PLAN}/out"),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_bad_input_is_one_line(name, tmp_path):
    check_failure(palms("track", *DAMAGES[name], cwd=tmp_path))
    assert list(tmp_path.iterdir()) == []


def test_wrong_usage_is_exit_code_2():
    result = palms("track", PLAN)
    assert result.returncode == 2
    assert "Usage: palms track" in result.stderr


def test_a_reader_that_goes_away_is_no_error():
    shell = f'"{sys.executable}" -m palms track "{PLAN}" "{SCAN}" "{WALK}" --json - | head -c 1'
    result = subprocess.run(
        shell, shell=True, capture_output=True, text=True, timeout=120, check=False
    )
    assert result.stdout == "{"
    assert "Error" not in result.stderr
    assert "Traceback" not in result.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full here")
def test_a_full_disk_is_one_line():
    with open("/dev/full", "w") as full:
        result = subprocess.run(
            [*COMMAND, "formats"], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert result.returncode == 1
    assert result.stderr == "palms: error: No space left on device\n"


def listen_to_interrupts():
    """Undo what a shell does to a test run in its background: there interrupts are ignored."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def wait_for_interpreter(pid):
    """Wait until a Python process handles interrupts; before that nobody could be quiet."""
    status = Path(f"/proc/{pid}/status")
    while status.exists():
        caught = re.search(r"^SigCgt:\s*(\w+)$", status.read_text(), re.MULTILINE)
        if caught is None or int(caught[1], 16) & 1 << (signal.SIGINT - 1):
            return
        time.sleep(0.01)


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("after_s", [1.0, 3.0])
def test_interrupt_is_quiet(tmp_path, after_s):
    arguments = ["track", PLAN, SCAN, WALK, "--trials", "2000", "--json", str(tmp_path / "a.json")]
    with subprocess.Popen(
        [*COMMAND, *arguments], stderr=subprocess.PIPE, text=True,
        preexec_fn=listen_to_interrupts,  # noqa: PLW1509 - it takes no lock
    ) as process:  # fmt: skip
        try:
            wait_for_interpreter(process.pid)
            time.sleep(after_s)
            process.send_signal(signal.SIGINT)
            _, said = process.communicate(timeout=60)
        finally:
            process.kill()
    assert (process.returncode, said) == (130, "")
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_while_a_class_is_made_ends_the_command_as_any_other(tmp_path):
    """Python remembers one that went through an `exec`, and kills a module's run in the end."""
    (tmp_path / "interrupted.py").write_text(
        "import palms.cli.app\n"
        "def app(prog_name):\n    exec('raise KeyboardInterrupt')\n"
        "palms.cli.app.app = app\n"
        "palms.cli.main()\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "interrupted"], cwd=tmp_path, capture_output=True, text=True,
        timeout=60, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


def test_an_interrupt_that_fell_into_a_callback_is_not_lost():
    """As a signal that arrives while the compiler calls back, where Python can raise nothing."""
    script = (
        "import ctypes, signal, sys, time\n"
        "from palms.cli import _again\n"
        "sys.unraisablehook = _again\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "press = ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.SIGINT))\n"
        "try:\n    press()\n    time.sleep(20)\n"
        "except KeyboardInterrupt:\n    print('stopped')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.stdout, done.stderr) == ("stopped\n", "")
