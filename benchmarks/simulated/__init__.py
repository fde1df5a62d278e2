"""The experiments on simulated buildings that docs/results.md reports on.

``python -m benchmarks.simulated STUDY --work DIR --results docs/results.md`` (from the root of
the repository) simulates what is missing in DIR, runs what is left to run, and writes the tables.
Stopped anywhere, the same command goes on.
"""
