"""A picture of scan, template, heatmaps and candidates: heatmaps.png."""

import palms
from palms.heatmap import find_candidates, match, scan_drifts
from palms.io import open_dataset
from palms.plot.output import write_figure
from palms.plot.pipeline import pipeline_figure
from palms.sample import sample_folder

case = open_dataset(sample_folder()).cases[0]
scan, label = case.scan(), case.label()

raster = palms.rasterize(case.plan())
heatmaps = match(scan, raster, scan_drifts(scan, raster))
figure = pipeline_figure(
    heatmaps, find_candidates(heatmaps), truth_m=None if label is None else label.position_m
)
write_figure("heatmaps.png", figure, dpi=100)
print("heatmaps.png")
