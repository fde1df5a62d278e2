"""Random numbers keyed by (seed, step, purpose, particle).

Every number that a particle draws depends on these four alone: not on the order in which
particles are visited, nor on the number of threads. `RandomKey` is the value that is handed
around; the compiled loops draw from it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palms.errors import SettingsError

__all__ = ["RandomKey", "as_key"]

_MASK = (1 << 64) - 1


def _mix(x: int) -> int:
    """Apply the finalizer of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014)."""
    x = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & _MASK
    x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & _MASK
    return x ^ (x >> 31)


@dataclass(frozen=True, slots=True)
class RandomKey:
    """Where a stream of random numbers begins.

    Parameters
    ----------
    value : int
        64 bits.

    Examples
    --------
    >>> key = as_key(7)
    >>> key.child(3) == as_key(7).child(3), key.child(3) == key.child(4)
    (True, False)
    """

    value: int

    def child(self, *labels: int) -> RandomKey:
        """Return the key of a step, a purpose...; the same labels give the same key."""
        value = self.value
        for label in labels:
            value = _mix((value + 0x9E3779B97F4A7C15 * (2 * label + 1)) & _MASK)
        return RandomKey(value)

    @property
    def word(self) -> np.uint64:
        """The key as the compiled loops take it."""
        return np.uint64(self.value)

    def uniform(self) -> float:
        """Return one number in [0, 1)."""
        return (_mix((self.value + 0x9E3779B97F4A7C15) & _MASK) >> 11) * 2.0**-53


def as_key(rng: int | np.random.Generator | RandomKey) -> RandomKey:
    """Turn what a user passes as `rng` into a key.

    Parameters
    ----------
    rng : int, numpy Generator or RandomKey
        A seed; a generator, from which one number is drawn; or a key as it is.

    Raises
    ------
    SettingsError
        When it is anything else or a negative seed.

    Examples
    --------
    >>> as_key(0) == as_key(0), as_key(0) == as_key(1)
    (True, False)
    """
    if isinstance(rng, RandomKey):
        return rng
    if isinstance(rng, np.random.Generator):
        return RandomKey(int(rng.integers(1 << 63)))
    if isinstance(rng, (int, np.integer)) and not isinstance(rng, bool) and rng >= 0:
        return RandomKey(_mix(int(rng) & _MASK)).child(0)
    raise SettingsError("rng", expected="a seed of 0 or more, or a numpy Generator", got=repr(rng))
