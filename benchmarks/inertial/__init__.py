"""Dead reckoning on the mall's raw logs, against the waypoints that people tagged.

``python -m benchmarks.inertial --out DIR`` (from the root of the repository) runs it; the data
folder is ``$PALMS_DATA``, else ``../shared/data``.
"""
