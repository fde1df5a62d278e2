"""Write what a user of the sample building might have: a picture, a RoomPlan scan, a pose log.

They are made from the sample's plan, scan and walk, which stand beside them in the folder:
``python tools/make_phone_files.py`` rewrites ``src/palms/sample/data/phone``. The script
``make_sample.py`` calls it.
"""

from __future__ import annotations

import argparse
import io as streams
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from make_plan_files import picture
from make_scan_files import roomplan, session
from palms import io
from palms.geometry import FloatArray
from palms.io.files import make_folder

SAMPLE = Path(__file__).resolve().parents[1] / "src" / "palms" / "sample" / "data"
HELD_M, LOOK_DOWN_RAD = 1.3, -0.3  # ours: how the phone is held on the walk
UPTIME_MS = 105_230_574  # ours: logs count from when the phone was switched on
LOG_RATE_HZ = 5.0  # ours: enough for steps


def write_phone_files(sample: Path) -> None:
    """Write the folder `phone` of a sample data set."""
    folder = make_folder(sample / "phone")
    (case,) = io.open_dataset(sample).cases
    image = streams.BytesIO()
    picture(case.plan()).convert("1").save(image, "PNG", optimize=True)
    (folder / "plan.png").write_bytes(image.getvalue())
    io.write_json(folder / "room.json", roomplan(case.scan().walls_m))
    walk = case.walk().odometry("arkit")
    time = np.concatenate([[0.0], walk.time_s])
    io.write_text(folder / "poses.csv", pose_log(time, np.concatenate([[[0, 0]], walk.position_m])))


def pose_log(time_s: FloatArray, ground_m: FloatArray) -> str:
    """Return a log of camera poses, y up, of someone who walks through points (T, 2)."""
    log_s = np.arange(0.0, time_s[-1], 1 / LOG_RATE_HZ)
    ground = np.column_stack([np.interp(log_s, time_s, each) for each in ground_m.T])
    place = session(ground, HELD_M + 0.03 * np.sin(1.7 * log_s))
    ahead = np.gradient(ground, axis=0)
    facing = np.arctan2(ahead[:, 1], ahead[:, 0])
    yaw = Rotation.from_euler("y", (facing - np.pi / 2)[:, None])
    turn = (yaw * Rotation.from_euler("x", LOOK_DOWN_RAD)).as_quat(canonical=True)
    lines = ["timestamp_ms,tx,ty,tz,qx,qy,qz,qw"]
    for t, p, q in zip(log_s.tolist(), place.tolist(), turn.tolist(), strict=True):
        numbers = [*(f"{v + 0.0:.3f}" for v in p), *(f"{v + 0.0:.4f}" for v in q)]
        lines.append(",".join([str(UPTIME_MS + round(1000 * t)), *numbers]))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sample", type=Path, default=SAMPLE)
    write_phone_files(parser.parse_args().sample)
