"""The goals of the default method beside what it reached, from results that are there."""
