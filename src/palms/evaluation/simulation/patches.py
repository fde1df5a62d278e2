"""From the points where rays met walls to planes: merged, then with a phone's errors."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from palms.evaluation.simulation.rays import group_lines
from palms.evaluation.simulation.settings import ScannerNoise
from palms.geometry import FloatArray, directions, lengths, rotate

__all__ = ["merge_patches", "noisy_planes"]

_LINE_M, _LINE_RAD = 0.06, 0.02  # simulation: planes nearer than this become one
_END_M = 0.1  # simulation: a surface seen to within this of its end is seen to its end
_GRAZING_RAD = np.deg2rad(60.0)  # simulation: incidence beyond which planes are missed more
_SPURIOUS_LENGTH_M = (0.5, 1.5)  # simulation: fronts of cupboards and desks
_SPURIOUS_DEPTH_M = (0.3, 0.7)  # simulation: how far in front of the wall


def merge_patches(
    segments_m: FloatArray, hits_m: FloatArray, index: npt.NDArray[np.int64], gap_m: float
) -> FloatArray:
    """Join the points seen on each straight line into patches.

    Parameters
    ----------
    segments_m : ndarray (N, 2, 2)
        The surfaces.
    hits_m : ndarray (R, 2)
        Where rays ended.
    index : ndarray (R,)
        The surface that each ray met, -1 for none.
    gap_m : float
        Points of one line with a gap below this between them are one patch.

    Returns
    -------
    ndarray (K, 2, 2)
        Their ends, in the frame of the segments.

    Examples
    --------
    >>> wall = np.array([[[0.0, 0.0], [5.0, 0.0]]])
    >>> hits = np.array([[0.05, 0.0], [0.8, 0.0], [3.0, 0.0], [3.5, 0.0]])
    >>> merge_patches(wall, hits, np.zeros(4, int), 1.0)[:, :, 0].round(6).tolist()
    [[0.0, 0.8], [3.0, 3.5]]
    """
    met = np.unique(index[index >= 0])
    patches = [np.empty((0, 2, 2))]
    line = group_lines(segments_m[met], _LINE_M, _LINE_RAD)
    for number in range(line.max(initial=-1) + 1):
        members = met[line == number]
        base = segments_m[members[lengths(segments_m[members]).argmax()]]
        along = (base[1] - base[0]) / np.linalg.norm(base[1] - base[0])
        across = np.array([-along[1], along[0]])
        points = hits_m[np.isin(index, members)] - base[0]
        places = [(hits_m[index == m] - base[0]) @ along for m in members]
        ends = [(segments_m[m] - base[0]) @ along for m in members]
        seen = np.sort(np.concatenate([*places, *map(_reached_ends, places, ends)]))
        cuts = np.flatnonzero(np.diff(seen) >= gap_m) + 1
        stretches = np.array([[part[0], part[-1]] for part in np.split(seen, cuts)])
        foot = base[0] + across * (points @ across).mean()
        patches.append(foot + stretches[..., None] * along)
    return np.concatenate(patches)


def _reached_ends(places: FloatArray, ends: FloatArray) -> FloatArray:
    """Those ends of a surface that were all but seen."""
    return np.asarray(ends[np.abs(ends[:, None] - places[None]).min(axis=1) < _END_M])


def noisy_planes(
    patches_m: FloatArray, here_m: FloatArray, noise: ScannerNoise, rng: np.random.Generator
) -> FloatArray:
    """Report patches as a phone does: some missed, all a little off, a few made up.

    Parameters
    ----------
    patches_m : ndarray (K, 2, 2)
        What was seen.
    here_m : ndarray (2,)
        From where, in the same frame.
    noise : ScannerNoise
    rng : numpy.random.Generator

    Returns
    -------
    ndarray (M, 2, 2)
        None shorter than `noise.min_length_m`.

    Examples
    --------
    >>> patches = np.array([[[2.0, -1.0], [2.0, 1.0]], [[2.0, 1.0], [1.8, 1.0]]])
    >>> rng = np.random.default_rng(0)
    >>> noisy_planes(patches, np.zeros(2), ScannerNoise.none(), rng).round(6).tolist()
    [[[2.0, -1.0], [2.0, 1.0]]]
    """
    long = patches_m[lengths(patches_m) >= noise.min_length_m]
    grazing = np.clip((_incidence(long, here_m) - _GRAZING_RAD) / (np.pi / 2 - _GRAZING_RAD), 0, 1)
    missed = noise.missed_share + noise.grazing_missed_share * grazing
    found = long[rng.random(len(long)) >= missed]
    planes = np.concatenate([found, _spurious(long, here_m, noise, rng)])
    moved = _perturbed(planes, noise, rng)
    return moved[lengths(moved) >= noise.min_length_m]


def _incidence(patches: FloatArray, here: FloatArray) -> FloatArray:
    """Angle (K,) between the line of sight to each patch's middle and its normal."""
    sight = patches.mean(axis=1) - here
    turn = np.arctan2(sight[:, 1], sight[:, 0]) - directions(patches)
    return np.asarray(np.pi / 2 - np.abs(np.arcsin(np.sin(turn))))


def _perturbed(planes: FloatArray, noise: ScannerNoise, rng: np.random.Generator) -> FloatArray:
    count = len(planes)
    angle = directions(planes) + rng.normal(0.0, noise.angle_sd_rad, count)
    half = lengths(planes)[:, None] / 2 * np.array([-1.0, 1.0])
    half = half + rng.normal(0.0, noise.end_sd_m, (count, 2))
    along = np.column_stack([np.cos(angle), np.sin(angle)])
    off = rng.normal(0.0, noise.normal_sd_m, count)[:, None] * along[:, ::-1] * [-1.0, 1.0]
    return np.asarray((planes.mean(axis=1) + off)[:, None] + half[..., None] * along[:, None])


def _spurious(
    patches: FloatArray, here: FloatArray, noise: ScannerNoise, rng: np.random.Generator
) -> FloatArray:
    """Planes in front of walls and parallel to them, where furniture may stand."""
    count = int(rng.poisson(noise.spurious_count)) if len(patches) else 0
    chosen = patches[rng.integers(0, max(len(patches), 1), count)]
    half = np.minimum(rng.uniform(*_SPURIOUS_LENGTH_M, count), lengths(chosen)) / 2
    play = lengths(chosen) / 2 - half
    middle = rng.uniform(-1.0, 1.0, count) * play
    along = (chosen[:, 1] - chosen[:, 0]) / np.maximum(lengths(chosen), 1e-9)[:, None]
    normal = rotate(along, np.pi / 2)
    distance = ((here - chosen[:, 0]) * normal).sum(axis=1)
    depth = np.sign(distance) * np.minimum(
        rng.uniform(*_SPURIOUS_DEPTH_M, count), np.abs(distance) * 0.6
    )
    foot = chosen.mean(axis=1) + along * middle[:, None] + normal * depth[:, None]
    return np.asarray(np.stack([foot - along * half[:, None], foot + along * half[:, None]], 1))
