"""What a scan says about a place: a likelihood, searched over the whole building.

The walls that were seen should lie on walls of the plan, and no wall of the plan should stand
where the scan proves empty space. Walls err as wholes: one that the plan draws 20 cm off, or
does not have, is one error and not one for each of its metres
(docs/explanation/likelihood.md).
"""

from palms.observation.likelihood import log_likelihood
from palms.observation.points import ScanPoints, scan_points
from palms.observation.search import Likelihoods, likelihoods, search
from palms.observation.sight import Sight, blurred, see

__all__ = [
    "Likelihoods",
    "ScanPoints",
    "Sight",
    "blurred",
    "likelihoods",
    "log_likelihood",
    "scan_points",
    "search",
    "see",
]
