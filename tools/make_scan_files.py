"""Write the tests' small scans, one of each format, all of one place in the sample building.

Run it after a change of what the files hold: ``python tools/make_scan_files.py``. It
rewrites ``tests/io/data/scans``; ``--out FOLDER`` writes elsewhere. LAZ and E57 need their
extras. ``walls.json`` is what every reader must find, as segments on the ground (x, -z).
"""

from __future__ import annotations

import argparse
import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from palms import io
from palms.evaluation.simulation import (
    DepthCamera,
    DepthSequence,
    WorldNoise,
    make_world,
    sample_building,
    take_depth,
)
from palms.evaluation.simulation.rays import group_lines
from palms.geometry import FloatArray, lengths
from palms.scan import Scan

SEED = 7  # ours
START_M = (34.5, 25.1)  # ours: in the lounge, which opens on a corridor; map frame
DRIFT_RAD = 2.13  # ours: the sample's
HEIGHT_M, CAMERA_M = 2.5, 1.4  # ours: of walls; of the session's origin above the floor
DOOR_M = (0.7, 1.3)  # ours: gaps of this width are doors, others openings
SHORTEST_M = 0.8  # ours: of what every reader must find
DATA = Path(__file__).resolve().parents[1] / "tests" / "io" / "data" / "scans"
CAMERA = DepthCamera(columns=64, rows=48, frames=30, noise_m=0.002, noise_share=0.003,
                     drift_m=0.0, drift_rad=0.0, pitch_rad=0.0)  # fmt: skip
IMAGE = (1920, 1440)  # of the colour image that the intrinsics are for

Json = dict[str, Any]


def joined(seen: FloatArray) -> FloatArray:
    """Stretches (N, 2, 2) with those on one line and without a gap between made one."""
    found = []
    line = group_lines(seen, 0.01, 0.01)
    for number in range(line.max() + 1):
        own = seen[line == number]
        base = own[lengths(own).argmax()]
        along = (base[1] - base[0]) / np.linalg.norm(base[1] - base[0])
        places = np.sort((own - base[0]) @ along, axis=1)
        places = places[places[:, 0].argsort()]
        start, end = places[0]
        for a, b in places[1:]:
            if a - end > 0.3:
                found.append(base[0] + np.array([[start], [end]]) * along)
                start = a
            end = max(end, b)
        found.append(base[0] + np.array([[start], [end]]) * along)
    return np.array(found)


def session(ground: FloatArray, height: float | FloatArray) -> FloatArray:
    """Points (..., 3) of an AR session, whose ground is (x, -z)."""
    x, y = ground[..., 0], ground[..., 1]
    return np.stack([x, np.broadcast_to(height, x.shape), -y], axis=-1)


def plane_matrix(wall: FloatArray, tilted: bool) -> FloatArray:
    """Anchor of a wall's plane: y its normal, x along the wall, or up when it is tilted."""
    ends = session(wall, HEIGHT_M / 2 - CAMERA_M)
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    up = np.array([0.0, 1.0, 0.0])
    x, z = (up, along) if tilted else (along, -up)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    matrix[:3, 3] = ends.mean(axis=0)
    return matrix


def quaternion(rotation: FloatArray) -> list[float]:
    """x, y, z, w of a rotation."""
    from scipy.spatial.transform import Rotation

    return [float(q) for q in Rotation.from_matrix(rotation).as_quat()]


def flat(matrix: FloatArray) -> list[float]:
    """Sixteen numbers by columns."""
    return [round(float(v), 6) + 0.0 for v in matrix.T.ravel()]


def arkit(walls: FloatArray) -> list[Json]:
    """Anchors; every other one has its x axis up, one is turned in its plane, one is a table."""
    planes = []
    for i, wall in enumerate(walls):
        tilted, width = i % 2 == 1, float(lengths(wall[None])[0])
        matrix, turn = plane_matrix(wall, tilted), 0.0
        if i % 3 == 0:
            turn = 0.4
            c, s = np.cos(turn), np.sin(turn)
            back = np.eye(4)
            back[:3, :3] = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T
            matrix = matrix @ back
        size = (HEIGHT_M, width) if tilted else (width, HEIGHT_M)
        planes.append(
            {
                "identifier": f"wall-{i}", "alignment": "vertical", "classification": "wall",
                "transform": flat(matrix), "center": [0.0, 0.0, 0.0],
                "planeExtent": {
                    "width": round(size[0], 6), "height": round(size[1], 6),
                    "rotationOnYAxis": turn,
                },
            }
        )  # fmt: skip
    lying = {"alignment": "horizontal", "transform": flat(np.eye(4)), "center": [0, 0, 0]}
    extent = {"width": 1.2, "height": 0.8, "rotationOnYAxis": 0.0}
    return [*planes, {**lying, "classification": "table", "planeExtent": extent}]


def rectangle(wall: FloatArray) -> list[tuple[float, float]]:
    """Corners x, z of a wall in its plane."""
    x, z = float(lengths(wall[None])[0]) / 2, HEIGHT_M / 2
    return [(round(a * x, 6), round(b * z, 6)) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def pose(matrix: FloatArray) -> tuple[list[float], list[float]]:
    """Position and quaternion, rounded."""
    return (
        [round(float(v), 6) + 0.0 for v in matrix[:3, 3]],
        [round(q, 8) + 0.0 for q in quaternion(matrix[:3, :3])],
    )


def webxr(walls: FloatArray) -> Json:
    """Planes of a WebXR session, a table among them."""
    planes = []
    for wall in walls:
        place, turn = pose(plane_matrix(wall, False))
        planes.append(
            {
                "orientation": "vertical", "semanticLabel": "wall",
                "pose": {
                    "position": dict(zip("xyz", place, strict=True)),
                    "orientation": dict(zip("xyzw", turn, strict=True)),
                },
                "polygon": [{"x": x, "y": 0, "z": z} for x, z in rectangle(wall)],
            }
        )  # fmt: skip
    table = {**planes[0], "orientation": "horizontal", "semanticLabel": "table"}
    return {"planes": [*planes, table], "viewer": {"position": {"x": 0, "y": 0, "z": 0}}}


def arcore(walls: FloatArray) -> Json:
    """Planes of ARCore: some by polygon, some by extent, one subsumed by another."""
    planes: list[Json] = []
    for i, wall in enumerate(walls):
        place, turn = pose(plane_matrix(wall, False))
        width = round(float(lengths(wall[None])[0]), 6)
        plane: Json = {
            "id": i, "type": "VERTICAL", "trackingState": "TRACKING", "subsumedBy": None,
            "centerPose": {"translation": place, "rotation": turn},
            "extentX": width, "extentZ": HEIGHT_M,
        }  # fmt: skip
        if i % 2:
            plane["polygon"] = [number for corner in rectangle(wall) for number in corner]
        planes.append(plane)
    old = {**planes[0], "id": len(walls), "subsumedBy": 0, "extentX": 9.0}
    return {"planes": [*planes, old]}


def roomplan(walls: FloatArray) -> Json:
    """Return a room whose walls run through doors and openings."""
    room: dict[str, list[Json]] = {"walls": [], "doors": [], "windows": [], "openings": []}
    line = group_lines(walls, 0.01, 0.01)
    for number in range(line.max() + 1):
        own = walls[line == number]
        base = own[0]
        along = (base[1] - base[0]) / np.linalg.norm(base[1] - base[0])
        places = np.sort((own - base[0]) @ along, axis=1)
        places = places[places[:, 0].argsort()]
        spans = [("walls", places.min(), places.max())]
        for end, start in zip(places[:-1, 1], places[1:, 0], strict=True):
            is_door = DOOR_M[0] <= start - end <= DOOR_M[1]
            spans.append(("doors" if is_door else "openings", end, start))
        for kind, a, b in spans:
            wall = base[0] + np.array([[a], [b]]) * along
            room[kind].append(surface(wall, kind, f"wall-{number}"))
    return {"version": 2, "story": 0, "identifier": "room", **room, "objects": [], "floors": []}


def surface(wall: FloatArray, kind: str, parent: str) -> Json:
    """Return a surface of a room: x along it, y up."""
    ends = session(wall, HEIGHT_M / 2 - CAMERA_M)
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    up = np.array([0.0, 1.0, 0.0])
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([along, up, np.cross(along, up)], axis=1)
    matrix[:3, 3] = ends.mean(axis=0)
    word = kind.removesuffix("s")
    detail = {"isOpen": False} if word == "door" else {}
    return {
        "identifier": parent if kind == "walls" else f"{word} of {parent}",
        "parentIdentifier": None if kind == "walls" else parent,
        "category": {word: detail}, "confidence": {"high": {}}, "curve": None,
        "completedEdges": [], "dimensions": [round(float(lengths(wall[None])[0]), 6), HEIGHT_M, 0],
        "transform": flat(matrix),
    }  # fmt: skip


def cloud(walls: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Points (P, 3) of a session: walls, floor, a table, and a few strays."""
    parts = []
    for wall in walls:
        count = int(220 * HEIGHT_M * lengths(wall[None])[0])
        along, height = rng.random(count), rng.random(count) * HEIGHT_M - CAMERA_M
        ground = wall[0] + along[:, None] * (wall[1] - wall[0]) + rng.normal(0, 0.004, (count, 2))
        parts.append(session(ground, height))
    low, high = walls.min(axis=(0, 1)), walls.max(axis=(0, 1))
    floor = low + rng.random((2000, 2)) * (high - low)
    parts.append(session(floor, -CAMERA_M + rng.normal(0, 0.004, 2000)))
    table = np.array([0.4, -0.3]) + rng.random((300, 2)) * [0.6, 0.4]
    parts.append(session(table, -CAMERA_M + 0.74 + rng.normal(0, 0.004, 300)))
    parts.append(session(low + rng.random((60, 2)) * (high - low), rng.random(60) * 2 - 1.2))
    return np.concatenate(parts).round(3)


def write_clouds(folder: Path, points: FloatArray) -> None:
    """Write one cloud in every format of clouds, y up; LAZ and E57 with z up."""
    names = "\n".join(f"property float {axis}" for axis in "xyz")
    head = f"element vertex {len(points)}\n{names}\nelement face 1\n"
    head += "property list uchar int vertex_indices\nend_header\n"
    face = np.array([0, 1, 2], "<i4").tobytes()
    (folder / "cloud.ply").write_bytes(
        f"ply\nformat binary_little_endian 1.0\ncomment made by palms\n{head}".encode()
        + points.astype("<f4").tobytes() + b"\x03" + face
    )  # fmt: skip
    rows = "".join(f"{x:.3f} {y:.3f} {z:.3f}\n" for x, y, z in points)
    (folder / "cloud-ascii.ply").write_text(f"ply\nformat ascii 1.0\n{head}{rows}3 0 1 2\n")
    np.savez_compressed(folder / "cloud.npz", xyz_mm=np.round(points * 1000).astype(np.int32))
    z_up = points[:, [0, 2, 1]] * [1, -1, 1]
    import laspy
    import pye57

    las = laspy.LasData(laspy.LasHeader(point_format=0, version="1.2"))
    las.header.scales, las.header.offsets = [0.001] * 3, [0.0] * 3
    las.x, las.y, las.z = z_up.T
    las.write(str(folder / "cloud.laz"))
    (folder / "cloud.e57").unlink(missing_ok=True)
    file = pye57.E57(str(folder / "cloud.e57"), mode="w")
    file.write_scan_raw(
        {f"cartesian{a}": np.ascontiguousarray(z_up[:, k]) for k, a in enumerate("XYZ")}
    )
    file.close()


def in_session(frame_pose: FloatArray, ground: FloatArray) -> FloatArray:
    """Camera to session, of a session whose points `ground` takes to the ground and up."""
    matrix = np.eye(4)
    lowered = frame_pose[:3].copy()
    lowered[2, 3] -= CAMERA_M
    matrix[:3] = ground.T @ lowered
    return matrix


def write_depth(folder: Path, taken: DepthSequence) -> None:
    """Write depth images as the data set of the paper has them, and as Stray Scanner has."""
    from PIL import Image

    from palms.io.depth_folder import GROUND as PALMS
    from palms.io.stray_scanner import GROUND as USUAL

    scale = IMAGE[0] / CAMERA.columns
    focal = float(taken.frames[0].focal_px[0]) * scale
    lens = [[focal, 0.0, IMAGE[0] / 2 - 0.5], [0.0, focal, IMAGE[1] / 2 - 0.5], [0.0, 0.0, 1.0]]
    for name in ("depths", "poses", "intrinsics"):
        (folder / "depth" / name).mkdir(parents=True)
    stray = folder / "stray"
    for name in ("depth", "confidence"):
        (stray / name).mkdir(parents=True)
    rows = ["timestamp, frame, x, y, z, qx, qy, qz, qw"]
    for i, frame in enumerate(taken.frames):
        put(folder / "depth" / "depths" / f"depth_{i}.json", [
            [None if np.isnan(v) else round(float(v), 3) for v in row] for row in frame.depth_m
        ])  # fmt: skip
        matrix = in_session(frame.pose, PALMS)
        put(folder / "depth" / "poses" / f"cameraPose_{i}.json", {"data": matrix.tolist()})
        put(folder / "depth" / "intrinsics" / f"cameraIntrinsics_{i}.json", {"data": lens})
        matrix = in_session(frame.pose, USUAL)
        turn = quaternion(matrix[:3, :3] @ np.diag([1.0, -1.0, -1.0]))
        numbers = [*matrix[:3, 3], *turn]
        rows.append(f"{i / 10:.1f}, {i:06d}, " + ", ".join(f"{v:.8f}" for v in numbers))
        depth = np.nan_to_num(frame.depth_m * 1000).astype(np.uint16)
        Image.fromarray(depth).save(stray / "depth" / f"{i:06d}.png")
        sure = np.where(np.isnan(frame.depth_m), 0, 2).astype(np.uint8)
        Image.fromarray(sure).save(stray / "confidence" / f"{i:06d}.png")
    (stray / "odometry.csv").write_text("\n".join(rows) + "\n")
    (stray / "camera_matrix.csv").write_text(
        "\n".join(", ".join(f"{v:.6f}" for v in row) for row in lens) + "\n"
    )


def put(path: Path, value: object) -> None:
    """Write JSON without spaces."""
    path.write_text(json.dumps(value, separators=(",", ":")) + "\n")


def make_scan_files(folder: Path) -> Sequence[Path]:
    """Write all files into a folder, which is replaced; return them."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    rng = np.random.default_rng(SEED)
    world = make_world(sample_building(), WorldNoise.none(), rng)
    taken = take_depth(world, START_M, DRIFT_RAD, CAMERA, rng)
    seen = joined(taken.seen_m)
    walls = seen[lengths(seen) >= SHORTEST_M].round(4)
    put(folder / "walls.json", walls.tolist())
    io.write_scan_json(Scan(walls), folder / "planes.json")
    put(folder / "arkit-planes.json", arkit(walls))
    put(folder / "roomplan.json", roomplan(walls))
    put(folder / "webxr-planes.json", webxr(walls))
    put(folder / "arcore-planes.json", arcore(walls))
    write_clouds(folder, cloud(walls, rng))
    write_depth(folder, taken)
    return sorted(file for file in folder.rglob("*") if file.is_file())


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=DATA, help="where to (default: the tests)")
    files = make_scan_files(parser.parse_args().out)
    for file in files:
        if file.parent.name not in ("depths", "poses", "intrinsics", "depth", "confidence"):
            print(f"{file.stat().st_size:8d}  {file.name}")
    print(f"{sum(file.stat().st_size for file in files):8d}  in all, {len(files)} files")


if __name__ == "__main__":
    main()
