from __future__ import annotations

import gzip
import json
import zipfile
from pathlib import Path

import numpy as np
import pytest

from palms.errors import FormatError, InputError, PalmsError, PalmsWarning
from palms.io import ODOMETRY, choose_format, read_walk
from palms.io.sensor_logger import read_sensor_logger
from tests.io.sensor_records import pushed, records

DATA = Path(__file__).parent / "data" / "walks"


@pytest.fixture(scope="module")
def right():
    return read_sensor_logger(DATA / "sensor-logger-android.zip").odometry("ronin")


@pytest.fixture
def pack(tmp_path):
    """Write a recording of the given system with files left out, replaced or added."""

    def write(system: str = "ios", without=(), folder: str = "", **changed: str) -> Path:
        path = tmp_path / "recording.zip"
        with (
            zipfile.ZipFile(DATA / f"sensor-logger-{system}.zip") as source,
            zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as target,
        ):
            files = {Path(name).stem: source.read(name).decode() for name in source.namelist()}
            for name, text in (files | changed).items():
                if name not in without:
                    target.writestr(f"{folder}{name}.csv", text)
        return path

    return write


def same(walk, right) -> bool:
    """Whether two walks are one, but for rounding; a mirrored one is not."""
    return len(walk) == len(right) and np.abs(walk.position_m - right.position_m).max() < 0.05


@pytest.mark.parametrize("system", ["android", "ios"])
@pytest.mark.parametrize(
    "without", [(), ("Metadata",), ("Orientation",), ("Pedometer", "Metadata")]
)
def test_signs_are_found(pack, right, system, without):
    assert same(read_sensor_logger(pack(system, without)).odometry("ronin"), right)


@pytest.mark.parametrize("system", ["android", "ios"])
def test_without_a_hint_the_screen_is_taken_to_look_up(pack, right, system):
    path = pack(system, ("Metadata", "Orientation"))
    with pytest.warns(PalmsWarning, match="say which with the option platform"):
        assert same(read_sensor_logger(path).odometry("ronin"), right)
    assert same(read_sensor_logger(path, platform=system).odometry("ronin"), right)
    wrong = {"android": "ios", "ios": "android"}[system]
    assert not same(read_sensor_logger(path, platform=wrong).odometry("ronin"), right)


def test_a_standardised_iphone_has_android_s_signs(pack, right):
    told = "platform,standardisation\nios,true\n"
    assert same(read_sensor_logger(pack("android", Metadata=told)).odometry("ronin"), right)


@pytest.mark.parametrize("system", ["android", "ios"])
def test_attitudes_may_be_given_either_way_round(pack, system):
    plain = read_sensor_logger(pack(system), heading="attitude").odometry("ronin")
    with zipfile.ZipFile(pack(system)) as archive:
        header, *rows = archive.read("Orientation.csv").decode().splitlines()
    negated = []
    for row in rows:
        time, seconds, qz, qy, qx, qw = row.split(",")
        negated.append(f"{time},{seconds},{-float(qz)},{-float(qy)},{-float(qx)},{qw}")
    other = pack(system, Orientation="\n".join([header, *negated]))
    assert same(read_sensor_logger(other, heading="attitude").odometry("ronin"), plain)


def test_uncalibrated_acceleration_of_an_iphone_is_in_g(pack, right):
    with zipfile.ZipFile(pack("ios")) as archive:
        parts = []
        for name in ("Accelerometer", "Gravity"):
            header, *rows = archive.read(f"{name}.csv").decode().splitlines()
            order = [header.split(",").index(axis) for axis in "xyz"]
            parts.append([[float(row.split(",")[k]) for k in order] for row in rows])
            clock = [row.split(",")[1] for row in rows]
    felt = (np.array(parts[0]) + np.array(parts[1])) / 9.80665
    lines = [f"{t},{x:.6f},{y:.6f},{z:.6f}" for t, (x, y, z) in zip(clock, felt, strict=True)]
    path = pack(
        "ios", ("Accelerometer", "Gravity"),
        AccelerometerUncalibrated="\n".join(["seconds_elapsed,x,y,z", *lines]),
    )  # fmt: skip
    assert same(read_sensor_logger(path).odometry("ronin"), right)


def test_times_in_nanoseconds_serve_alone(pack, right):
    with zipfile.ZipFile(pack("ios")) as archive:
        texts = {name: archive.read(f"{name}.csv").decode()
                 for name in ("Accelerometer", "Gravity", "Gyroscope")}  # fmt: skip
    changed = {name: text.replace("seconds_elapsed", "other", 1) for name, text in texts.items()}
    walk = read_sensor_logger(pack("ios", ("Orientation",), **changed)).odometry("ronin")
    assert same(walk, right)


def test_in_a_folder_inside_the_archive(pack, right):
    assert same(read_walk(pack("ios", folder="2026-01-01/")).odometry("ronin"), right)


def flat(message: dict) -> dict:
    """A message whose records hold the values beside name and time."""
    rows = [
        {**{key: row[key] for key in ("name", "time")}, **row["values"]}
        for row in message["payload"]
    ]
    return message | {"payload": rows}


JSON_FORMS = {
    "the export": records,
    "messages in a list": pushed,
    "one message a line": lambda system: "\n".join(map(json.dumps, pushed(system))),
    "messages in any order": lambda system: pushed(system)[::-1],
    "values beside the name": lambda system: [flat(message) for message in pushed(system)],
    "one message": lambda system: {
        "payload": [row for each in pushed(system) for row in each["payload"]]
    },
}


@pytest.mark.parametrize("system", ["android", "ios"])
@pytest.mark.parametrize("form", JSON_FORMS.values(), ids=JSON_FORMS)
def test_json_says_the_same_as_the_archive(put, right, system, form):
    path = put("recording.json", form(system))
    walk = read_walk(path).odometry("ronin")
    assert same(walk, right)
    assert walk.time_s[0] == pytest.approx(right.time_s[0], abs=0.05)
    assert choose_format(ODOMETRY, path).name == "sensor-logger"


def test_json_may_be_packed(put, right):
    path = put("recording.json.gz", gzip.compress(json.dumps(records("ios")).encode()))
    assert same(read_walk(path).odometry("ronin"), right)


def test_damaged_records_are_left_out_with_a_word(put, right):
    rows = records("ios")
    rows[20:22] = [{"sensor": "Gravity", "time": "soon", "x": "1", "y": "2", "z": "3"}, 7]
    rows[30]["x"] = None
    with pytest.warns(PalmsWarning, match="2 of"):
        walk = read_sensor_logger(put("recording.json", rows)).odometry("ronin")
    assert same(walk, right)


BAD_JSON = {
    "cut in a record": (lambda text: text[: len(text) // 2], "cut off"),
    "cut between records": (lambda text: text[: text.index("},") + 1], "does not end"),
    "no sensor": (lambda text: '[{"sensor": "Light", "time": 1}]', "got none"),
    "no accelerometer": (
        lambda text: '[{"sensor": "Gravity", "time": 1, "x": 1, "y": 1, "z": 1}]', "accelerometer"),
    "no numbers": (lambda text: text.replace('": "', '": "a'), "expected"),
    "other things": (lambda text: "[7, [], {}, null]", "got none"),
    "too deep": (lambda text: '[{"sensor": ' + "[" * 100_000, "recording.json"),
    "too much": (lambda text: text, "at most 0.1 MB"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "part"), BAD_JSON.values(), ids=BAD_JSON)
def test_what_is_wrong_with_json_is_said(put, says, monkeypatch, change, part):
    text = json.dumps(records("ios"))
    if part.startswith("at most"):
        monkeypatch.setattr("palms.io.sensor_logger_files._MOST_BYTES", 100_000)
    path = put("recording.json", change(text))
    with pytest.raises(FormatError) as caught:
        read_walk(path, format="sensor-logger")
    says(caught.value, "recording.json", part)


BAD = {
    "no gyroscope": ({"without": ("Gyroscope", "Orientation")}, "gyroscope"),
    "no accelerometer": ({"without": ("Accelerometer",)}, "Accelerometer.csv"),
    "an empty sensor": ({"Accelerometer": ""}, "an empty file"),
    "other columns": ({"Gyroscope": "a,b\n1,2\n"}, "a, b"),
    "words": ({"Gyroscope": "seconds_elapsed,x,y,z\n" + "a,b,c,d\n" * 99}, "99 of 99"),
    "one row": ({"Accelerometer": "seconds_elapsed,x,y,z\n1,0,0,0\n"}, "accelerometer"),
    "no attitude": ({"Orientation": "seconds_elapsed,qx,qy,qz,qw\n" + "0,0,0,0,0\n40,0,0,0,0\n",
                     "without": ("Gyroscope",)}, "unit quaternions"),
    "another time": ({"Gyroscope": "seconds_elapsed,x,y,z\n" + "900,0,0,0\n901,0,0,0\n"}, "2 s"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "part"), BAD.values(), ids=BAD)
def test_what_is_wrong_is_said(pack, says, change, part):
    path = pack("ios", **change)
    with pytest.raises(InputError) as caught:
        read_sensor_logger(path)
    says(caught.value, "recording.zip", part)


def test_archives_cannot_reach_outside(pack, tmp_path, right):
    up = "../" * len(tmp_path.parts)
    path = pack("ios", folder=f"{up}{tmp_path.relative_to(tmp_path.anchor)}/outside/")
    assert same(read_sensor_logger(path).odometry("ronin"), right)
    assert list(tmp_path.iterdir()) == [path]


def test_bombs_are_refused(pack, monkeypatch, says):
    monkeypatch.setattr("palms.io.archives.MAX_BYTES", 1_000_000)
    huge = "seconds_elapsed,x,y,z\n" + "1,0,0,0\n" * 200_000
    path = pack("ios", Gyroscope=huge)
    with pytest.raises(FormatError) as caught:
        read_sensor_logger(path)
    says(caught.value, "Gyroscope.csv", "at most 1 MB")
    content = path.read_bytes().replace(
        len(huge).to_bytes(4, "little"), (900_000).to_bytes(4, "little")
    )
    path.write_bytes(content)  # an archive that lies about its size
    with pytest.raises(PalmsError, match=r"recording\.zip"):
        read_sensor_logger(path)


def test_a_table_of_contents_beyond_any_log_is_not_read(tmp_path, monkeypatch, says):
    path = tmp_path / "many.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for k in range(200):
            archive.writestr(f"{k}.csv", "")
        archive.writestr("Accelerometer.csv", "seconds_elapsed,x,y,z\n")
    monkeypatch.setattr("palms.io.archives._MAX_DIRECTORY", 5_000)
    with pytest.raises(FormatError) as caught:
        read_walk(path, format="sensor-logger")
    says(caught.value, "many.zip", "no such file in it")


def test_an_archive_behind_a_password_is_refused(pack, says):
    path = pack("ios")
    content = bytearray(path.read_bytes())
    for mark, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        at = content.find(mark)
        while at >= 0:
            content[at + offset] |= 1
            at = content.find(mark, at + 4)
    path.write_bytes(content)
    with pytest.raises(FormatError) as caught:
        read_sensor_logger(path)
    says(caught.value, "recording.zip", "without a password")
