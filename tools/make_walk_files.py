"""Write the walk files that the tests read: one walk, the sample's, in each format.

    python tools/make_walk_files.py          # rewrites tests/io/data/walks

Pose formats hold the first samples of the walk with a phone that looks where it goes, held at a
height that varies; inertial ones what the sensors of a phone read on some of its steps. The same
bytes every time.
"""

from __future__ import annotations

import argparse
import io
import json
import sys
import zipfile
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from palms.inertial import InertialLog  # noqa: E402
from palms.inertial.log import GRAVITY_M_S2  # noqa: E402
from palms.io import read_tracking  # noqa: E402
from palms.sample import sample_folder  # noqa: E402
from tests.inertial.walker import Phone, sense  # noqa: E402

DATA = ROOT / "tests" / "io" / "data" / "walks"
SAMPLES = 80  # ours: about 45 m with three corners, and files under 30 kB
STEPS = 50  # ours: half a minute of sensors
SEED = 12
EPOCH_MS = 1_700_000_000_000
UPTIME_NS = 105_230_574_092_166
RONIN_RATE_HZ = 50
TURN_RAD = 0.7  # of the frames that are a walk's own


def poses() -> tuple[np.ndarray, np.ndarray, Rotation]:
    """Return times, positions and camera rotations: y up, camera along -z, from the origin."""
    walk = read_tracking(sample_folder() / "trajectories" / "sample" / "walk-1").odometry()
    time = np.concatenate([[0.0], walk.time_s[:SAMPLES]])
    ground = np.concatenate([[[0.0, 0.0]], walk.position_m[:SAMPLES]])
    height = 1.3 + 0.03 * np.sin(1.7 * time)
    place = np.column_stack([ground[:, 0], height, -ground[:, 1]])
    moves = np.diff(ground, axis=0, append=ground[-1:])
    moves[-1] = moves[-2]
    facing = np.arctan2(moves[:, 1], moves[:, 0])
    yaw = Rotation.from_euler("y", (facing - np.pi / 2)[:, None])
    return time, place, yaw * Rotation.from_euler("x", -0.3)


def steps() -> tuple[np.ndarray, np.ndarray]:
    """Return when and where some steps of the walk ended, and the start before them."""
    walk = read_tracking(sample_folder() / "trajectories" / "sample" / "walk-1").odometry()
    return walk.time_s[: STEPS + 1], walk.position_m[: STEPS + 1]


def text_files() -> dict[str, str]:
    """Return pose logs as text, by the name of their file."""
    time, place, turn = poses()
    quaternion = turn.as_quat()
    matrix = np.tile(np.eye(4), (len(time), 1, 1))
    matrix[:, :3, :3], matrix[:, :3, 3] = turn.as_matrix(), place
    columns = np.swapaxes(matrix, 1, 2)
    z_up = Rotation.from_euler("x", np.pi / 2)  # (x, y, z) with y up becomes (x, -z, y)
    raised, turned = z_up.apply(place), (z_up * turn).as_quat()
    nanoseconds = [UPTIME_NS + round(t * 1e9) for t in time.tolist()]
    return {
        "tum-z.tum": "# timestamp tx ty tz qx qy qz qw\n" + _rows(_seconds(time), raised, turned),
        "tum-y.txt": _rows(_seconds(time), place, quaternion),
        "arkit-3x4-ns.txt": "# Created by a logger\n"
        + _rows(nanoseconds, matrix[:, :3].reshape(-1, 12)),
        "arkit-4x4-columns.csv": _rows(_seconds(time), columns.reshape(-1, 16), between=","),
        "arkit-3x4-columns.txt": _rows(_seconds(time), columns[:, :, :3].reshape(-1, 12)),
        "arcore-ns.csv": "timestamp_ns,tx,ty,tz,qx,qy,qz,qw\n"
        + _rows(nanoseconds, place, quaternion, between=","),
        "stray-odometry.csv": "timestamp, frame, x, y, z, qx, qy, qz, qw\n"
        + _rows(_seconds(time), [f"{k:06d}" for k in range(len(time))], place, quaternion,
                between=", "),
        "arkit-transform.json": _transforms(time, columns),
        "arcore-ms.jsonl": _lines_of_json(time, place, quaternion),
        "steps.csv": _steps(),
        "android.txt": _android(),
    }  # fmt: skip


def _seconds(time: np.ndarray) -> list[str]:
    return [f"{t:.6f}" for t in time.tolist()]


def _rows(*parts: object, between: str = " ") -> str:
    lines = []
    for row in zip(*parts, strict=True):  # type: ignore[call-overload]
        cells = [
            [f"{v:.6f}" for v in cell] if isinstance(cell, np.ndarray) else [str(cell)]
            for cell in row
        ]
        lines.append(between.join(cell for part in cells for cell in part) + "\n")
    return "".join(lines)


def _rounded(values: np.ndarray, digits: int = 6) -> list[object]:
    listed: list[object] = (np.round(values, digits) + 0.0).tolist()
    return listed


def _transforms(time: np.ndarray, columns: np.ndarray) -> str:
    frames = [
        {"frame": k, "timestamp": round(2000.25 + t, 6), "transform": _rounded(each)}
        for k, (t, each) in enumerate(zip(time.tolist(), columns, strict=True))
    ]
    return json.dumps({"device": "made", "frames": frames}) + "\n"


def _lines_of_json(time: np.ndarray, place: np.ndarray, quaternion: np.ndarray) -> str:
    lines = [
        json.dumps(
            {
                "time_ms": EPOCH_MS + round(1000 * t),
                "tracking": "TRACKING",
                "position": dict(zip("xyz", _rounded(p), strict=True)),
                "rotation": dict(zip("xyzw", _rounded(q), strict=True)),
            }
        )
        for t, p, q in zip(time.tolist(), place, quaternion, strict=True)
    ]
    return "\n".join(lines) + "\n"


def _steps() -> str:
    time, place = steps()
    moves = np.diff(place, axis=0)
    heading = np.degrees(np.arctan2(moves[:, 1], moves[:, 0]) + TURN_RAD)
    rows = zip(time[1:], np.linalg.norm(moves, axis=1), heading, strict=True)
    return "t_s,length_m,heading_deg\n" + "".join(f"{t:.4f},{m:.5f},{h:.3f}\n" for t, m, h in rows)


def sensed() -> tuple[InertialLog, np.ndarray]:
    """Return what the sensors read, and where the walker was at the ends of steps."""
    found = sense(*steps(), Phone(rate_hz=50.0), np.random.default_rng(SEED))
    return found.log, np.column_stack([found.step_s, steps()[1][1:]])


def _android() -> str:
    """Return an Android log with waypoints, other types, and lines damaged as they really are."""
    log, walked = sensed()
    start = steps()[1][0]
    rows: list[tuple[int, str]] = [(0, "TYPE_DIST1\t4.5\t1.9\t-10.5")]
    rows += [(0, f"TYPE_WAYPOINT\t{start[0] + 100:.4f}\t{start[1] + 50:.4f}")]
    rows += [
        (round(1000 * t), f"TYPE_WAYPOINT\t{x + 100:.4f}\t{y + 50:.4f}")
        for t, x, y in walked[9::10].tolist()
    ]
    assert log.rate_rad_s is not None
    assert log.attitude is not None
    vector = log.attitude[:, :3] * np.sign(log.attitude[:, 3:])
    for kind, values in (
        ("ACCELEROMETER", log.acceleration_m_s2),
        ("GYROSCOPE", log.rate_rad_s),
        ("ROTATION_VECTOR", vector),
    ):
        for t, each in zip(log.time_s.tolist(), values.tolist(), strict=True):
            cells = "\t".join(f"{v:.4f}" for v in each)
            rows.append((round(1000 * t), f"TYPE_{kind}\t{cells}\t3"))
    rows += [(1000 * k, "TYPE_WIFI\tab12\tc0:ff:ee\t-61\t2437") for k in range(1, 20)]
    lines = [f"{EPOCH_MS + t}\t{row}" for t, row in sorted(rows, key=lambda row: row[0])]
    lines[200:202] = [lines[200] + lines[201]]  # a lost line end
    cut = next(k for k in range(400, len(lines)) if "TYPE_GYROSCOPE" in lines[k])
    lines[cut] = lines[cut].rsplit("\t", 3)[0]  # a row that was cut
    head = ["#\tstartTime:" + str(EPOCH_MS), "#\tSiteName:Sample\tFloorName:2"]
    return "\n".join([*head, *lines]) + "\n"


def sensor_logger(system: str) -> bytes:
    """Return a zip archive as the app writes it on Android, or with an iPhone's signs."""
    log, _ = sensed()
    assert log.rate_rad_s is not None
    assert log.attitude is not None
    turn = Rotation.from_quat(np.array(log.attitude))
    gravity = turn.inv().apply([0.0, 0.0, GRAVITY_M_S2])
    sign = 1.0 if system == "android" else -1.0
    files = {
        "Metadata": "version,platform,appVersion,standardisation\n"
        f"3,{system},1.60,false\n",
        "Accelerometer": _sensor(log.time_s, sign * (log.acceleration_m_s2 - gravity), "zyx"),
        "Gravity": _sensor(log.time_s, sign * gravity, "zyx" if system == "android" else "xyz"),
        "Gyroscope": _sensor(log.time_s, log.rate_rad_s, "zyx"),
        "Orientation": _sensor(log.time_s, log.attitude, ("qz", "qy", "qx", "qw")),
        "Pedometer": "time,seconds_elapsed,steps\n",
    }  # fmt: skip
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(zipfile.ZipInfo(f"{name}.csv"), text, zipfile.ZIP_DEFLATED, 9)
    return buffer.getvalue()


def _sensor(time: np.ndarray, values: np.ndarray, order: str | tuple[str, ...]) -> str:
    names = "xyz" if values.shape[1] == 3 else ("qx", "qy", "qz", "qw")
    columns = [list(names).index(name) for name in order]
    lines = [
        f"{EPOCH_MS * 1_000_000 + round(t * 1e9)},{t:.4f},"
        + ",".join(f"{v:.4f}" for v in row[columns])
        for t, row in zip(time.tolist(), values, strict=True)
    ]
    return "\n".join([f"time,seconds_elapsed,{','.join(order)}", *lines]) + "\n"


def ronin() -> bytes:
    """Return an array as RoNIN saves it: its track, turned, beside the reference."""
    time, place, _ = poses()
    even = np.arange(time[0], time[-1], 1 / RONIN_RATE_HZ)
    ground = np.column_stack(
        [np.interp(even, time, place[:, 0]), np.interp(even, time, -place[:, 2])]
    )
    c, s = np.cos(TURN_RAD), np.sin(TURN_RAD)
    track = ground @ np.array([[c, s], [-s, c]]) + [3.0, -2.0]
    buffer = io.BytesIO()
    np.save(buffer, np.column_stack([track, ground]).astype(np.float32))
    return buffer.getvalue()


def write(folder: Path) -> None:
    """Write all files into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in text_files().items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
    for system in ("android", "ios"):
        (folder / f"sensor-logger-{system}.zip").write_bytes(sensor_logger(system))
    (folder / "ronin.npy").write_bytes(ronin())


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=DATA)
    write(parser.parse_args().out)
