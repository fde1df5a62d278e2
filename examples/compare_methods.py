"""Several methods and seeds on one walk, wrong declarations counted."""

import numpy as np

import palms
from palms.io import open_dataset
from palms.sample import sample_folder

SEEDS = range(3)
WRONG_M = 2.0

case = open_dataset(sample_folder()).cases[0]
walk = case.walk()
odometry = walk.odometry()
for method in ("uniform", "uniform-ori", "paper"):
    settings = palms.Settings.for_method(method)
    declared, wrong = 0, 0
    for track in palms.track_trials(case.plan(), case.scan(), odometry, settings, SEEDS, jobs=2):
        step = next((i for i, each in enumerate(track) if each.is_localized), None)
        if step is not None:
            declared += 1
            wrong += np.linalg.norm(track.position_m[step] - walk.reference_m[step]) > WRONG_M
    print(f"{method:12} declared {declared} of {len(SEEDS)}, wrong {wrong}")
