"""The voice: what somebody who does not look at the screen is told, in sentences.

::

    estimates ──> Moment ─┐
    scans ─────> View ────┼─> Narrator ──> Saying (kind, text, details)
    questions ────────────┤      │
    free words ─> Understood     └── Voice: Surroundings, Preferences, Catalogue

All of it is values: no clock but the times that are passed in, no state but the narrator that
is returned. The rules and their why: docs/explanation/voice.md.
"""

from palms.voice.catalogue import Catalogue, languages, read_catalogue
from palms.voice.moments import Moment
from palms.voice.narrator import Kind, Narrator, Question, Saying
from palms.voice.places import Placed, Voice
from palms.voice.preferences import Preferences
from palms.voice.surroundings import Surroundings
from palms.voice.understanding import Named, Understood, understand

__all__ = [
    "Catalogue",
    "Kind",
    "Moment",
    "Named",
    "Narrator",
    "Placed",
    "Preferences",
    "Question",
    "Saying",
    "Surroundings",
    "Understood",
    "Voice",
    "languages",
    "read_catalogue",
    "understand",
]
