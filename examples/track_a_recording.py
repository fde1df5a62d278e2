"""One call from plan, scan and walk to answers."""

import palms
from palms.sample import sample_folder

folder = sample_folder()
plan = palms.read_floorplan(folder / "maps/sample.csv")
scan = palms.read_scan(folder / "trajectories/sample/walk-1/Session_1001")
walk = palms.read_walk(folder / "trajectories/sample/walk-1").odometry("arkit")

track = palms.track(plan, scan, walk, rng=0)

if track.localized_at_s is None:
    print("not localized")
else:
    print(f"localized after {track.localized_at_s:.0f} s")
last = track.estimates[-1]
print(f"at the end: {last.stage}, {plan.room_at(last.position_m)}, x y {last.position_m.round(1)}")
print(f"within 2 m with {last.p_within_2m:.0%}, by its own account")
