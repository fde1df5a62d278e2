"""Where one scan may have been taken: many places, and how probable each is."""

import math

import palms
from palms.io import open_dataset
from palms.places import find_places
from palms.sample import sample_folder

case = open_dataset(sample_folder()).cases[0]
plan = case.plan()

places = find_places(palms.locate(plan, case.scan()))
for place in places[:5]:
    room = plan.room_at((place.x_m, place.y_m))
    degrees = math.degrees(place.drift_rad)
    print(f"{place.p:6.2%}  {room}, x {place.x_m:.1f}, y {place.y_m:.1f}, drift {degrees:.0f} deg")
print(f"{len(places)} places in all: the scan alone does not decide")
