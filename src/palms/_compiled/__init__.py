"""Compiled loops: arrays in, arrays out; no classes, no input or output.

Each is C in numba's clothes (flat arrays, own random numbers, no closures) and has a slow
twin in the tests. A file calls no compiled function of another file, because numba's cache
notices only changes of the file itself.
"""
