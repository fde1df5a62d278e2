"""Plan, scan and walk from arrays instead of files."""

import numpy as np

import palms

# Two rooms with a door between them, in metres, y up.
walls = [
    [[0, 0], [9, 0]], [[9, 0], [9, 6]], [[9, 6], [0, 6]], [[0, 6], [0, 0]],
    [[4, 0], [4, 2]], [[4, 3], [4, 6]], [[9, 4], [6, 4]],
]  # fmt: skip
door = [[4, 2], [4, 3]]
classes = [palms.SegmentClass.WALL] * len(walls) + [palms.SegmentClass.DOOR]
rooms = (
    palms.Room("Kitchen", [[0, 0], [4, 0], [4, 6], [0, 6]]),
    palms.Room("Living room", [[4, 0], [9, 0], [9, 6], [4, 6]]),
)
plan = palms.FloorPlan([*walls, door], np.array(classes), rooms=rooms, name="flat")

# What the phone saw from (1.5, 4.5): the kitchen, in the map's axes, so the drift is 0.
seen = np.array([walls[3], [[0, 0], [4, 0]], walls[4], walls[5], [[0, 6], [4, 6]]])
scan = palms.Scan(seen - (1.5, 4.5))

# It goes down 2 m and then through the door.
way = np.array([(0, -0.5 * i) for i in range(1, 5)] + [(0.5 * i, -2) for i in range(1, 13)])
walk = palms.Odometry(0.5 * np.arange(1, len(way) + 1), way)

track = palms.track(plan, scan, walk, rng=0)
for estimate in track.estimates[::3]:
    x, y = estimate.position_m
    room = plan.room_at((x, y))
    print(f"{estimate.time_s:4.1f} s  {estimate.stage:9}  x {x:.1f}, y {y:.1f}  {room}")
