"""Moves as they arrive: say nothing as a position before it is localized."""

import palms
from palms.io import open_dataset
from palms.sample import sample_folder

case = open_dataset(sample_folder()).cases[0]  # stands in for a phone
plan = case.plan()

localizer = palms.Localizer(plan, rng=0)
localizer.observe(case.scan())
said = None
for move in case.walk().odometry().moves():
    estimate = localizer.move(move)
    place = plan.room_at(estimate.position_m) if estimate.is_localized else "not localized yet"
    if place != said:
        print(f"{estimate.time_s:6.1f} s  {place}")
        said = place
