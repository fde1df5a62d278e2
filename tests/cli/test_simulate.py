import json

import pytest

from palms.io import open_dataset

QUICK = ("--length", 30, "--no-pictures")


@pytest.fixture(scope="module")
def made(palms, tmp_path_factory):
    out = tmp_path_factory.mktemp("simulate") / "d"
    arguments = ("--building", "office", "--seed", 7, "--starts", 2, "--walks", 1, "--out", out)
    result = palms("simulate", *arguments, "--length", 30, "--json", "-")
    assert result.exit_code == 0, result.output
    return out, json.loads(result.stdout)


def test_it_writes_a_data_set_with_pictures(made):
    out, document = made
    found = open_dataset(out)
    assert [case.title for case in found.cases] == [
        f"{row['scene']}/{row['walk']}" for row in document["cases"]
    ]
    assert all((case.folder / "picture.png").is_file() for case in found.cases)
    assert document["schema"] == "palms-simulate/1"
    assert document["cases"][0]["walked_m"] == pytest.approx(30, abs=4)


def test_same_command_same_bytes(made, palms, tmp_path):
    out, _ = made
    again = tmp_path / "again"
    arguments = ("--building", "office", "--seed", 7, "--starts", 2, "--walks", 1, "--length", 30)
    assert palms("simulate", *arguments, "--out", again).exit_code == 0
    assert contents(out) == contents(again)


def contents(folder):
    return {f.relative_to(folder): f.read_bytes() for f in folder.rglob("*") if f.is_file()}


def test_processes_make_the_same_bytes(palms, tmp_path):
    arguments = ("--building", "office", "--seed", 3, "--buildings", 2, "--starts", 3)
    arguments = (*arguments, "--walks", 1, "--length", 30, "--json", "-")
    found = []
    for jobs in (1, 2):
        out = tmp_path / str(jobs)
        result = palms("simulate", *arguments, "--jobs", jobs, "--out", out)
        assert result.exit_code == 0, result.output
        found.append((contents(out), json.loads(result.stdout)["cases"]))
    assert found[0] == found[1]
    assert [case["scene"] for case in found[0][1]] == ["office-3", "office-3", "office-4"]


def test_an_error_in_a_process_is_one_line(palms_fails, tmp_path):
    arguments = ("--building", "office", "--buildings", 2, "--starts", 2, "--double", "luck")
    line = palms_fails("simulate", *arguments, "--jobs", 2, "--out", tmp_path / "d")
    assert "nuisance to double: expected one of" in line


def test_starts_are_spread_over_buildings(palms, tmp_path):
    out = tmp_path / "d"
    arguments = ("--building", "office", "--seed", 3, "--buildings", 2, "--starts", 3)
    result = palms("simulate", *arguments, "--walks", 1, *QUICK, "--out", out)
    assert result.exit_code == 0, result.output
    assert "3 walks" in result.stdout
    scenes = [case.scene for case in open_dataset(out).cases]
    assert scenes == ["office-3", "office-3", "office-4"]
    assert not list(out.rglob("*.png"))


def test_a_plan_of_ones_own(palms, world, tmp_path):
    out = tmp_path / "d"
    arguments = (world.plan, "--starts", 1, "--walks", 1, "--odometry", "vio", "--rate", 4)
    result = palms("simulate", *arguments, *QUICK, "--hint", "place", "--jump", 10, "--out", out)
    assert result.exit_code == 0, result.output
    (case,) = open_dataset(out).cases
    assert (case.scene, case.walk().sources) == ("plan", ("arkit",))
    events = json.loads((case.folder / "events.json").read_text())
    assert {event["kind"] for event in events} == {"jump", "hint"}


@pytest.mark.parametrize(
    "arguments",
    [
        (), ("--building", "office", "plan.csv"), ("plan.csv", "--levels", 2),
        ("--building", "office", "--buildings", 9), ("--building", "office", "--starts", 0),
    ],
)  # fmt: skip
def test_wrong_usage(palms, tmp_path, arguments):
    assert palms("simulate", *arguments, "--out", tmp_path / "d").exit_code == 2


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--building", "castle"), "one of office, campus, got 'castle'"),
        (("--building", "office", "--length", 0), "CaseSettings.length_m"),
        (("--building", "office", "--double", "luck"), "nuisance to double"),
        (("no-such-plan.csv",), "no-such-plan.csv"),
    ],
)
def test_what_cannot_be_simulated(palms_fails, tmp_path, arguments, says):
    assert says in palms_fails("simulate", *arguments, "--out", tmp_path / "d")
    assert not (tmp_path / "d").exists()


def test_a_folder_with_files_is_left_alone(palms_fails, world):
    line = palms_fails("simulate", "--building", "office", "--out", world.folder)
    assert "expected a new folder" in line
