"""Binary frames: particles and heatmaps, little-endian, for viewers who ask.

A frame begins with the bytes ``PF`` (particles) or ``HF`` (heatmap) and a version byte. Particles
are two int16 each, in units of the frame's `scale_m` from its origin, and after all of these a byte
of label each: 10 kB for 2,000.
"""

from __future__ import annotations

import struct
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palms.errors import FormatError
from palms.geometry import FloatArray

__all__ = ["HeatmapFrame", "ParticlesFrame", "pack_heatmap", "pack_particles", "unpack_frame"]

VERSION = 1
LARGEST = 32_767  # of an int16
CENTIMETRE_M = 0.01
_PARTICLES = struct.Struct("<2sBxIddddf")  # kind, version, count, seq, t_s, x, y, scale
_HEATMAP = struct.Struct("<2sBBIddddfffHH")
# kind, version, map, of how many; seq, drift, x, y, cell, lowest, highest score, label, labels


class ParticlesFrame(NamedTuple):
    """Particles as a viewer gets them.

    Attributes
    ----------
    seq : int
        Of the input that they come after.
    t_s : float
        On the client's clock.
    position_m : (N, 2)
        Map frame, to a centimetre.
    label : (N,) uint8
        Candidate drift, modulo 256.
    """

    seq: int
    t_s: float
    position_m: FloatArray
    label: npt.NDArray[np.uint8]


class HeatmapFrame(NamedTuple):
    """One heatmap of the latest scan.

    Attributes
    ----------
    seq : int
        Of the scan.
    number, of : int
        Which map, of how many.
    drift_rad : float
    origin_m : (float, float)
        Lower left corner of the picture, map frame.
    cell_size_m : float
    range_nats : (float, float)
        The scores that black and white stand for; of a correlation they have no unit.
    png : bytes
        Grey, eight bits, top row first.
    label : int
        Of the particles of this drift.
    n_labels : int
        How many drifts there were; labels go round the circle in order.
    """

    seq: int
    number: int
    of: int
    drift_rad: float
    origin_m: tuple[float, float]
    cell_size_m: float
    range_nats: tuple[float, float]
    png: bytes
    label: int = 0
    n_labels: int = 0


def pack_particles(frame: ParticlesFrame) -> bytes:
    """Return the bytes of particles.

    Examples
    --------
    >>> two = ParticlesFrame(7, 1.5, np.array([[1.0, 2.0], [4.5, -3.25]]), np.zeros(2, np.uint8))
    >>> len(pack_particles(two)), unpack_frame(pack_particles(two)).position_m.tolist()
    (54, [[1.0, 2.0], [4.5, -3.25]])
    """
    low, high = frame.position_m.min(axis=0), frame.position_m.max(axis=0)
    origin = np.round(0.5 * (low + high), 2)
    scale = np.float32(max(CENTIMETRE_M, float((high - low).max()) / (2 * LARGEST) * 1.001))
    offset = np.round((frame.position_m - origin) / scale).astype("<i2")
    head = _PARTICLES.pack(
        b"PF", VERSION, len(offset), frame.seq, frame.t_s, *origin.tolist(), float(scale)
    )
    return b"".join([head, offset.tobytes(), frame.label.astype(np.uint8).tobytes()])


def pack_heatmap(frame: HeatmapFrame) -> bytes:
    """Return the bytes of a heatmap."""
    head = _HEATMAP.pack(
        b"HF", VERSION, frame.number, frame.of, frame.seq, frame.drift_rad, *frame.origin_m,
        frame.cell_size_m, *frame.range_nats, frame.label, frame.n_labels,
    )  # fmt: skip
    return head + frame.png


def unpack_frame(content: bytes) -> ParticlesFrame | HeatmapFrame:
    """Return what a binary frame holds.

    Raises
    ------
    FormatError
        When it is none of this version, or cut off.
    """
    head = {b"PF": _PARTICLES, b"HF": _HEATMAP}.get(content[:2])
    if head is None or len(content) < head.size or content[2] != VERSION:
        raise FormatError(
            "binary frame", expected=f"PF or HF, version {VERSION}", got=repr(content[:3])
        )
    return _particles(content) if head is _PARTICLES else _heatmap(content)


def _particles(content: bytes) -> ParticlesFrame:
    _, _, n, seq, t_s, x, y, scale = _PARTICLES.unpack_from(content)
    start = _PARTICLES.size
    if len(content) != start + 5 * n:
        raise FormatError("particles", expected=f"{start + 5 * n} bytes", got=str(len(content)))
    offset = np.frombuffer(content, "<i2", 2 * n, start).reshape(-1, 2)
    label = np.frombuffer(content, np.uint8, n, start + 4 * n)
    return ParticlesFrame(int(seq), t_s, np.round(offset * scale + np.array([x, y]), 6), label)


def _heatmap(content: bytes) -> HeatmapFrame:
    _, _, number, of, seq, drift, x, y, cell, *rest = _HEATMAP.unpack_from(content)
    low, high, label, n_labels = rest
    png = content[_HEATMAP.size :]
    return HeatmapFrame(
        int(seq), number, of, drift, (x, y), cell, (low, high), png, label, n_labels
    )
