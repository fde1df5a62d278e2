"""Write the test vectors: inputs and outputs of the compiled loops, for other ports of them.

    python tools/make_vectors.py          # writes tests/golden/vectors.json

The vectors are small, and exact: floats are written so that they read back to the same bits.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

from palms._compiled import clusters, raster, select, weights
from palms._compiled import filter as loops
from palms.floorplan import FloorPlan
from palms.raster import rasterize

PATH = Path(__file__).resolve().parents[1] / "tests" / "golden" / "vectors.json"
KEY = 0x1234567890ABCDEF
WALLS = [[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]], [[3, 0], [3, 2.5]]]


def vectors() -> dict[str, dict[str, object]]:
    """Return inputs and outputs by loop."""
    return {**_random(), **_filter(), **_cells(), **_clusters()}


def _random() -> dict[str, dict[str, object]]:
    normal, uniform = np.empty((5, 3)), np.empty((5, 3))
    loops.normals(np.uint64(KEY), 3, normal)
    loops.uniforms(np.uint64(KEY), 3, uniform)
    given = {"key": KEY, "particles": 5, "n": 3}
    return {
        "normals": {"in": given, "out": normal.tolist()},
        "uniforms": {"in": given, "out": uniform.tolist()},
    }


def _filter() -> dict[str, dict[str, object]]:
    walls = rasterize(FloorPlan(WALLS)).walls
    position = np.array([[1.0, 1.0], [2.8, 1.0], [2.8, 3.2], [5.5, 3.5]])
    drift, scale = np.array([0.0, 0.1, 0.0, 1.5]), np.array([1.0, 1.02, 0.98, 1.0])
    moved, turned, hit = np.empty((4, 2)), np.empty(4), np.empty(4, np.bool_)
    step, noise = (0.6, 0.05), (0.05, 0.016, 0.007)
    loops.move(
        position, drift, scale, step, noise, np.uint64(KEY), walls, moved, turned, hit
    )  # fmt: skip
    copied, copied_drift = moved.copy(), turned.copy()
    label, kept_scale = np.arange(4, dtype=np.int32), scale.copy()
    loops.replace_hits(
        copied, copied_drift, kept_scale, label, hit, np.array([0.1, 0.007]), np.uint64(KEY), walls
    )
    weight, index = np.array([0.1, 0.0, 0.6, 0.3]), np.empty(6, np.int64)
    weights.systematic(weight, 6, 0.25, index)
    sums, place = np.empty((2, 5)), np.array([0, 1, -1, 0], np.int8)
    loops.gathered(position, drift, weight, place, sums)
    given = {
        "position": position.tolist(), "drift": drift.tolist(), "scale": scale.tolist(),
        "step": step, "noise": noise, "key": KEY, "walls": WALLS, "cell_size": 0.1,
    }  # fmt: skip
    return {
        "move": {
            "in": given,
            "out": {"position": moved.tolist(), "drift": turned.tolist(), "hit": hit.tolist()},
        },
        "replace_hits": {
            "in": {"after": "move", "spread": [0.1, 0.007], "key": KEY},
            "out": {
                "position": copied.tolist(), "drift": copied_drift.tolist(),
                "label": label.tolist(), "scale": kept_scale.tolist(),
            },
        },
        "gathered": {
            "in": {"of": "move", "weights": weight.tolist(), "place": place.tolist()},
            "out": sums.tolist(),
        },
        "systematic": {
            "in": {"weights": weight.tolist(), "n": 6, "u": 0.25}, "out": index.tolist(),
        },
    }  # fmt: skip


def _cells() -> dict[str, dict[str, object]]:
    segments = np.array([[0.05, 0.05, 0.95, 0.35], [0.5, 0.0, 0.5, 0.8]])
    triangles = np.array([[0.0, 0.0, 0.9, 0.1, 0.2, 0.8]])
    lengths, empty = np.zeros((4, 5)), np.zeros((4, 5), np.uint8)
    raster.add_lengths(segments, np.ones(2), 0.2, True, lengths)
    raster.fill_triangles(triangles, 0.2, empty)
    values = np.array([0.5, -1.0, 3.0, 3.0, 2.0], np.float32)
    return {
        "add_lengths": {
            "in": {"segments": segments.tolist(), "weights": [1, 1], "cell": 0.2, "spread": True},
            "out": lengths.tolist(),
        },
        "fill_triangles": {
            "in": {"triangles": triangles.tolist(), "cell": 0.2}, "out": empty.tolist(),
        },
        "nth_largest": {
            "in": {"values": values.tolist(), "n": 3},
            "out": float(select.nth_largest(values, 3)),
        },
    }  # fmt: skip


def _clusters() -> dict[str, dict[str, object]]:
    points = np.array([[0.0, 0.0], [0.2, 0.1], [0.4, 0.0], [7.0, 7.0], [7.3, 7.1]])
    modes, member, counts = clusters.mean_shift(points, 1.0, 1e-3, 300)
    weight = np.array([0.1, 0.3, 0.2, 0.2, 0.2])
    quantile = np.empty(1)
    clusters.weighted_quantiles(np.arange(5.0), weight, np.array([0.68]), quantile)
    return {
        "mean_shift": {
            "in": {"points": points.tolist(), "bandwidth": 1.0},
            "out": {"modes": modes.tolist(), "member": member.tolist(), "counts": counts.tolist()},
        },
        "weighted_quantiles": {
            "in": {"distance": [0, 1, 2, 3, 4], "weight": weight.tolist(), "share": 0.68},
            "out": quantile[0],
        },
    }


def main() -> None:
    """Write the vectors."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=PATH)
    arguments = parser.parse_args()
    arguments.out.write_text(json.dumps(vectors(), indent=1) + "\n")
    print(arguments.out)


if __name__ == "__main__":
    main()
