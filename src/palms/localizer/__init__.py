"""Localizer for a live stream, track() for a recording: the method from end to end."""

from palms.localizer.live import Localizer, Watcher, locate
from palms.localizer.recorded import Happening, Track, track, track_trials

__all__ = ["Happening", "Localizer", "Track", "Watcher", "locate", "track", "track_trials"]
