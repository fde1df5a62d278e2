"""The real benchmark: laser logs of four buildings, plans fitted to what the start did not see.

``python -m benchmarks.real --out DIR`` (from the root of the repository) runs it; the data
folder is ``$PALMS_DATA``, else ``../shared/data``.
"""
