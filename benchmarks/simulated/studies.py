"""What the studies are: simulated buildings, and runs of methods on them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from palms.evaluation.experiment import Experiment
from palms.evaluation.oracle import ORACLE, ORACLE_PARTICLES
from palms.evaluation.simulation import NuisanceRanges


@dataclass(frozen=True)
class Run:
    """Methods on all walks of a data set; `out` is the folder of the results."""

    out: str
    methods: tuple[str, ...]
    trials: int
    particles: int | None = None
    walk_source: str = "arkit"

    def experiment(self, dataset: Path) -> Experiment:
        return Experiment(
            dataset, self.methods, self.trials, particles=self.particles,
            walk_source=self.walk_source,
        )  # fmt: skip

    def words(self, dataset: str) -> list[str]:
        """Return the command line, without the number of processes."""
        words = ["palms", "bench", dataset, "--methods", ",".join(self.methods)]
        words += ["--trials", str(self.trials)]
        if self.particles is not None:
            words += ["--particles", str(self.particles)]
        if self.walk_source != "arkit":
            words += ["--walk-source", self.walk_source]
        return [*words, "--out", self.out]


@dataclass(frozen=True)
class Dataset:
    """Simulated buildings; `options` are those of `palms simulate`."""

    name: str
    options: str

    def words(self) -> list[str]:
        """Return the command line, without the number of processes."""
        return ["palms", "simulate", *self.options.split(), "--out", self.name]


@dataclass(frozen=True)
class Study:
    """One data set, and the runs on it whose rows make up a table."""

    dataset: Dataset
    runs: tuple[Run, ...]

    def commands(self) -> list[list[str]]:
        """Return all command lines, in order."""
        return [self.dataset.words(), *(run.words(self.dataset.name) for run in self.runs)]


FLOORS = Dataset("floors", "--building office --buildings 3 --starts 7 --walks 2 --seed 7")
BUILDINGS = Dataset(
    "buildings",
    "--building office --buildings 400 --starts 400 --walks 1 --seed 1000 --no-pictures",
)

PAPER = Study(
    FLOORS,
    (
        Run("results-floors", ("uniform", "uniform-ori", "paper", "authors", "palms"), 100),
        Run("results-oracle", (ORACLE,), 10),
    ),
)
MANY = Study(
    BUILDINGS,
    (
        Run(
            "results-buildings",
            ("uniform", "uniform-ori", "paper", "authors", "palms", ORACLE), 1,
        ),
    ),
)  # fmt: skip
TWICE = (ORACLE_PARTICLES, 2 * ORACLE_PARTICLES)
DOUBLING = Study(FLOORS, tuple(Run(f"results-oracle-{n}", (ORACLE,), 5, n) for n in TWICE))


@dataclass(frozen=True)
class Nuisances:
    """Development buildings as they are, and with each nuisance twice as strong."""

    options: str = "--building office --buildings 30 --starts 30 --walks 1 --seed 100 --no-pictures"
    methods: tuple[str, ...] = ("paper", "palms")
    trials: int = 3
    names: tuple[str, ...] = tuple(
        name for name in NuisanceRanges.names()
        if not name.startswith(("inertial", "jump"))  # no walk here has these
    )  # fmt: skip

    def study(self, name: str | None = None) -> Study:
        """Return the study with a nuisance doubled; without a name, as it is."""
        word = name or "plain"
        options = f"{self.options} --double {name}" if name else self.options
        dataset = Dataset(f"buildings-{word}", options)
        return Study(dataset, (Run(f"results-{word}", self.methods, self.trials),))


HAPPENINGS = {
    "plain": "",
    "second-scan": "--second-scan 20",
    "jump": "--jump 60 --jump-by 20",
    "jump-and-scan": "--jump 60 --jump-by 20 --second-scan 65",
    "right-room": "--hint room --hint-after 0",
    "right-place": "--hint place --hint-after 0",
    "wrong-room": "--hint room --hint-after 0 --wrong-hint",
    "wrong-place": "--hint place --hint-after 0 --wrong-hint",
    "levels": "--levels 3",
}
INERTIAL = "inertial"


@dataclass(frozen=True)
class Happenings:
    """The same buildings and walks, each time with something else that happens on the way."""

    buildings: int = 400
    seed: int = 1000
    methods: tuple[str, ...] = ("palms", ORACLE)
    particles: int | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """What happens: walks as they are, those of `HAPPENINGS`, and inertial odometry."""
        return (*HAPPENINGS, INERTIAL)

    def study(self, name: str) -> Study:
        """Return the study of one of them; inertial odometry is that of the walks as they are."""
        n, happens = self.buildings, "plain" if name == INERTIAL else name
        options = f"--building office --buildings {n} --starts {n} --walks 1 --seed {self.seed}"
        dataset = Dataset(f"events-{n}-{happens}", f"{options} {HAPPENINGS[happens]} --no-pictures")
        source = "ronin" if name == INERTIAL else "arkit"
        run = Run(f"results-events-{n}-{name}", self.methods, 1, self.particles, source)
        return Study(dataset, (run,))
