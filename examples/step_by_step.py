"""The method's steps one by one, as the paper's section III has them."""

import palms
from palms.belief import Belief, settle, summarize
from palms.heatmap import find_candidates, match, scan_drifts
from palms.io import open_dataset
from palms.particles import advance, start_from
from palms.randomness import as_key
from palms.sample import sample_folder

case = open_dataset(sample_folder()).cases[0]
scan, walk = case.scan(), case.walk().odometry()
settings, key = palms.Settings.paper(), as_key(0)

raster = palms.rasterize(case.plan(), settings.raster)
drifts_rad = scan_drifts(scan, raster, settings)
heatmaps = match(scan, raster, drifts_rad, settings.template)
candidates = find_candidates(heatmaps, settings.candidates)
print(f"{len(heatmaps)} heatmaps of {heatmaps.grid.size:,} cells, {len(candidates):,} candidates")

particles = start_from(candidates, settings.start.n_particles, key.child(0), own_frame=False)
belief = Belief(particles)
for i, move in enumerate(walk.moves(), start=1):
    particles, info = advance(belief.particles, move, raster, settings.motion, key.child(i))
    before, belief = belief, settle(belief, particles, move, settings.convergence, key.child(i))
    if belief.stage != before.stage:
        answer = summarize(belief, move.time_s, None)
        print(f"{move.time_s:.1f} s: {belief.stage}, {answer.position_m.round(2)}")
