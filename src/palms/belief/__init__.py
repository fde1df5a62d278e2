"""Belief: what is known, and how sure; and the answer that it gives (paper III-D)."""

from palms.belief.belief import Belief, Spots, Stage, settle
from palms.belief.estimate import (
    Estimate,
    Hypothesis,
    gathered_m,
    hypotheses,
    summarize,
    whole_m,
)

__all__ = [
    "Belief",
    "Estimate",
    "Hypothesis",
    "Spots",
    "Stage",
    "gathered_m",
    "hypotheses",
    "settle",
    "summarize",
    "whole_m",
]
