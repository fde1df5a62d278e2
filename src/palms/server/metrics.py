"""Metrics: what a server counts, in the text format that Prometheus reads. No place, no name."""

from __future__ import annotations

from collections import Counter

__all__ = ["Metrics"]

_BUCKETS_S = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
_HELP = {
    "inputs_total": "Inputs stored and followed.",
    "estimates_total": "Estimates sent to walkers.",
    "sessions_opened_total": "Sessions opened.",
    "sessions_resumed_total": "Sessions that a client came back to.",
    "sessions_replayed_total": "Sessions rebuilt from their journal.",
    "refused_total": "Clients refused because the server was full.",
    "denied_total": "Requests and sockets denied.",
    "repeated_total": "Inputs that came again.",
    "errors_total": "Inputs that could not be used.",
    "defects_total": "Errors that palms is to blame for.",
    "slow_total": "Clients let go because they took too long.",
    "uploads_total": "Files read.",
}


class Metrics:
    """Counters, and how long steps took.

    Examples
    --------
    >>> metrics = Metrics()
    >>> metrics.count("inputs_total")
    >>> metrics.took(0.004)
    >>> "palms_inputs_total 1" in metrics.text({"sessions": 2})
    True
    """

    def __init__(self) -> None:
        self._counts: Counter[str] = Counter()
        self._steps: Counter[float] = Counter()
        self._n, self._sum_s = 0, 0.0

    def count(self, name: str) -> None:
        """Count one of what `name` stands for."""
        assert name in _HELP, name
        self._counts[name] += 1

    def took(self, seconds: float) -> None:
        """Note how long it was from an input's arrival to its estimate."""
        self._n += 1
        self._sum_s += seconds
        self._steps[next((b for b in _BUCKETS_S if seconds <= b), float("inf"))] += 1

    def text(self, gauges: dict[str, int]) -> str:
        """Return everything as text; gauges are what there is now."""
        lines = []
        for name, help_text in _HELP.items():
            lines += [f"# HELP palms_{name} {help_text}", f"# TYPE palms_{name} counter"]
            lines.append(f"palms_{name} {self._counts[name]}")
        for name, value in gauges.items():
            lines += [f"# TYPE palms_{name} gauge", f"palms_{name} {value}"]
        lines.append("# TYPE palms_step_seconds histogram")
        below = 0
        for bound in _BUCKETS_S:
            below += self._steps[bound]
            lines.append(f'palms_step_seconds_bucket{{le="{bound:g}"}} {below}')
        lines.append(f'palms_step_seconds_bucket{{le="+Inf"}} {self._n}')
        lines += [
            f"palms_step_seconds_sum {self._sum_s:.6f}",
            f"palms_step_seconds_count {self._n}",
        ]
        return "\n".join(lines) + "\n"
