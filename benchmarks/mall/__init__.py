"""The mall benchmark: real step odometry on three mall floors, scans simulated at the start.

``python -m benchmarks.mall --out DIR`` (from the root of the repository) runs it; the data
folder is ``$PALMS_DATA``, else ``../shared/data``.
"""
