"""Walls found in depth images and point clouds, against the truth where it is known."""
