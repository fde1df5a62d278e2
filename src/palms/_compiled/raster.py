"""Segments and triangles to cells."""

from __future__ import annotations

import math

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def add_lengths(segments, weights, cell, spread, out):
    """Add weight times length, in cells, of each segment (N, 4) to the cells it runs through.

    Coordinates are relative to the lower left corner of cell (0, 0); cells off the raster
    are left out. With `spread`, what runs through a cell is shared between the four cells
    whose centres surround its middle, so that the raster moves smoothly with the segment.
    """
    rows, columns = out.shape
    for i in range(segments.shape[0]):
        x0, y0 = segments[i, 0] / cell, segments[i, 1] / cell
        dx, dy = segments[i, 2] / cell - x0, segments[i, 3] / cell - y0
        length = math.sqrt(dx * dx + dy * dy)
        if length == 0.0:
            continue
        c, r = int(math.floor(x0)), int(math.floor(y0))
        step_c = 1 if dx > 0 else -1
        step_r = 1 if dy > 0 else -1
        delta_c = abs(1.0 / dx) if dx != 0 else math.inf
        delta_r = abs(1.0 / dy) if dy != 0 else math.inf
        next_c = math.inf
        if dx != 0:
            next_c = ((c + 1 - x0) if dx > 0 else (x0 - c)) * delta_c
        next_r = math.inf
        if dy != 0:
            next_r = ((r + 1 - y0) if dy > 0 else (y0 - r)) * delta_r
        t = 0.0
        while t < 1.0:
            ahead = min(next_c, next_r, 1.0)
            amount = weights[i] * (ahead - t) * length
            if spread:
                u = x0 + 0.5 * (t + ahead) * dx - 0.5
                v = y0 + 0.5 * (t + ahead) * dy - 0.5
                left, below = int(math.floor(u)), int(math.floor(v))
                u, v = u - left, v - below
                for k in range(4):
                    rr, cc = below + k // 2, left + k % 2
                    if 0 <= rr < rows and 0 <= cc < columns:
                        share = (v if k // 2 else 1.0 - v) * (u if k % 2 else 1.0 - u)
                        out[rr, cc] += amount * share
            elif 0 <= r < rows and 0 <= c < columns:
                out[r, c] += amount
            t = ahead
            if next_c <= next_r:
                next_c += delta_c
                c += step_c
            else:
                next_r += delta_r
                r += step_r


@njit(cache=True, nogil=True)
def number(segments, cell, out):
    """Number the cells that segments (N, 4) run through, and their neighbours, by segment.

    Coordinates are relative to the lower left corner of cell (0, 0). The last segment through
    a cell counts; a neighbour counts only where none runs through.
    """
    rows, columns = out.shape
    for beside in range(1, -1, -1):
        for i in range(segments.shape[0]):
            x, y = segments[i, 0] / cell, segments[i, 1] / cell
            dx, dy = segments[i, 2] / cell - x, segments[i, 3] / cell - y
            n = int(math.ceil(3.0 * math.sqrt(dx * dx + dy * dy))) + 1
            for k in range(n + 1):
                c, r = int(math.floor(x + k * dx / n)), int(math.floor(y + k * dy / n))
                for rr in range(max(0, r - beside), min(rows, r + beside + 1)):
                    for cc in range(max(0, c - beside), min(columns, c + beside + 1)):
                        out[rr, cc] = i


@njit(cache=True, nogil=True)
def fill_triangles(triangles, cell, out):
    """Set to 1 the cells of `out` whose centre lies in any of the triangles (N, 6).

    Coordinates are relative to the lower left corner of cell (0, 0). Centres on an edge
    count as inside, so that triangles that share an edge leave no hole.
    """
    rows, columns = out.shape
    for i in range(triangles.shape[0]):
        ax, ay = triangles[i, 0] / cell - 0.5, triangles[i, 1] / cell - 0.5
        bx, by = triangles[i, 2] / cell - 0.5, triangles[i, 3] / cell - 0.5
        cx, cy = triangles[i, 4] / cell - 0.5, triangles[i, 5] / cell - 0.5
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if abs(area) < 1e-12:
            continue
        if area < 0:
            bx, by, cx, cy = cx, cy, bx, by
        tolerance = -1e-9
        first_r = max(0, int(math.ceil(min(ay, by, cy))))
        last_r = min(rows - 1, int(math.floor(max(ay, by, cy))))
        first_c = max(0, int(math.ceil(min(ax, bx, cx))))
        last_c = min(columns - 1, int(math.floor(max(ax, bx, cx))))
        for r in range(first_r, last_r + 1):
            for c in range(first_c, last_c + 1):
                if (
                    (bx - ax) * (r - ay) - (by - ay) * (c - ax) >= tolerance
                    and (cx - bx) * (r - by) - (cy - by) * (c - bx) >= tolerance
                    and (ax - cx) * (r - cy) - (ay - cy) * (c - cx) >= tolerance
                ):
                    out[r, c] = 1


@njit(cache=True, nogil=True)
def _touches(x0, y0, x1, y1, left, bottom, right, top):
    """Whether a segment touches a box (Liang and Barsky 1984)."""
    t0, t1 = 0.0, 1.0
    dx, dy = x1 - x0, y1 - y0
    for side in range(4):
        if side == 0:
            p, q = -dx, x0 - left
        elif side == 1:
            p, q = dx, right - x0
        elif side == 2:
            p, q = -dy, y0 - bottom
        else:
            p, q = dy, top - y0
        if p == 0.0:
            if q < 0.0:
                return False
        else:
            t = q / p
            if p < 0.0:
                t0 = max(t0, t)
            else:
                t1 = min(t1, t)
    return t0 <= t1


@njit(cache=True, nogil=True)
def bucket_segments(segments, cell, rows, columns, slack):
    """List, for each bucket, the segments (N, 4) that come within `slack` of it.

    Returns
    -------
    start (rows * columns + 1,), items : bucket b holds items[start[b]:start[b + 1]].
    """
    start = np.zeros(rows * columns + 1, np.int32)
    items = np.empty(0, np.int32)
    for fill in range(2):
        for i in range(segments.shape[0]):
            x0, y0, x1, y1 = segments[i, 0], segments[i, 1], segments[i, 2], segments[i, 3]
            first_r = max(0, int(math.floor((min(y0, y1) - slack) / cell)))
            last_r = min(rows - 1, int(math.floor((max(y0, y1) + slack) / cell)))
            first_c = max(0, int(math.floor((min(x0, x1) - slack) / cell)))
            last_c = min(columns - 1, int(math.floor((max(x0, x1) + slack) / cell)))
            for r in range(first_r, last_r + 1):
                for c in range(first_c, last_c + 1):
                    left, bottom = c * cell - slack, r * cell - slack
                    side = cell + 2 * slack
                    if _touches(x0, y0, x1, y1, left, bottom, left + side, bottom + side):
                        b = r * columns + c
                        if fill:
                            items[start[b]] = i
                            start[b] += 1
                        else:
                            start[b + 1] += 1
        if not fill:
            for b in range(rows * columns):
                start[b + 1] += start[b]
            items = np.empty(start[rows * columns], np.int32)
    for b in range(rows * columns, 0, -1):
        start[b] = start[b - 1]
    start[0] = 0
    return start, items


@njit(cache=True, nogil=True)
def marked(position, mask, frame):
    """Indices of the positions (N, 2) whose cell of a mask (R, C) is set, in order.

    `frame` is x and y of the mask's lower left corner and cells per metre.
    """
    rows, columns = mask.shape
    out = np.empty(position.shape[0], np.int64)
    n = 0
    for i in range(position.shape[0]):
        c = math.floor((position[i, 0] - frame[0]) * frame[2])
        r = math.floor((position[i, 1] - frame[1]) * frame[2])
        if 0 <= c < columns and 0 <= r < rows and mask[int(r), int(c)]:
            out[n] = i
            n += 1
    return out[:n]


@njit(cache=True, nogil=True)
def tiles(position, frame, columns, out):
    """Fill out (N,) with the tile of each position (N, 2), row by row; some tile for those off.

    `frame` is x and y of the lower left corner, half of the gap around it, and width and
    height of a tile; `columns` are the tiles of a row and all tiles.
    """
    for i in range(position.shape[0]):
        c = math.floor((position[i, 0] - frame[0] + frame[2]) / frame[3])
        r = math.floor((position[i, 1] - frame[1] + frame[2]) / frame[4])
        c = min(max(c, 0.0), columns[0] - 1.0)
        out[i] = int(min(max(r * columns[0] + c, 0.0), columns[1] - 1.0))
