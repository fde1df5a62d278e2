"""The command: ``python -m benchmarks.voice --results docs/results.md``."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from statistics import median

from benchmarks.harness import machine_words
from benchmarks.page import around, put
from benchmarks.voice.walks import Sentence, Walk, speak
from palms.errors import PalmsError

SEED = 700  # neither these nor their walks served to set a number of the voice
GOAL = 1  # false sentences over a hundred walks


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("python -m benchmarks.voice", description=__doc__)
    add = parser.add_argument
    add("--walks", type=int, default=100, help="each in a building of its own")
    add("--seed", type=int, default=SEED, help="of the first building; the next has one more")
    add("--jobs", type=int, default=1, help="processes; the results do not depend on it")
    add("--results", type=Path, metavar="PAGE", help="put the table into this page")
    return parser


def walked(seeds: range, jobs: int) -> Iterator[Walk]:
    """Yield the walks, in order."""
    if jobs == 1:
        yield from map(speak, seeds)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(speak, seeds)


def table(walks: Sequence[Walk]) -> str:
    """Return what was said and what of it was false, as a page shows it."""
    about = [each for walk in walks for each in walk.about_place]
    sure = [each for each in about if each.verdict and each.verdict.is_sure]
    likely = [each for each in about if each.verdict and not each.verdict.is_sure]
    everything = sum(len(walk.sentences) for walk in walks)
    rows = [
        ("walks, and their metres", f"{len(walks)}, {sum(w.length_m for w in walks):,.0f}"),
        ("sentences in all", f"{everything:,}"),
        ("about a place", f"{len(about):,}"),
        ("with a direction", f"{sum(_has_direction(each) for each in about):,}"),
        ("**said without \"probably\"; of these false**", f"{len(sure):,}; **{_false(sure)}**"),
        ("said with \"probably\"; of these false", f"{len(likely):,}; {_false(likely)}"),
        ("what was false of all", _reasons(about)),
        ("name another room than the walker's; without \"probably\"",
         f"{_other_rooms(about)}; {_other_rooms(sure)}"),
        ("walks with a false sentence", f"{len({each.seed for each in about if _is_false(each)})}"),
        ("walks that are told a place; without \"probably\"",
         f"{sum(w.first_m() is not None for w in walks)}; "
         f"{sum(w.first_m(True) is not None for w in walks)}"),
        ("median metres to the first place; without \"probably\"",
         f"{_median(walks, False):.0f}; {_median(walks, True):.0f}"),
    ]  # fmt: skip
    lines = ["| over all walks | |", "|---|---:|", *(f"| {name} | {what} |" for name, what in rows)]
    return "\n".join(lines)


def _is_false(sentence: Sentence) -> bool:
    return sentence.verdict is not None and sentence.verdict.is_false


def _false(sentences: Sequence[Sentence]) -> int:
    return sum(_is_false(each) for each in sentences)


def _has_direction(sentence: Sentence) -> bool:
    return "o'clock" in (sentence.saying.details or "")


def _other_rooms(sentences: Sequence[Sentence]) -> int:
    return sum(bool(each.verdict and each.verdict.names_other_room) for each in sentences)


def _reasons(sentences: Sequence[Sentence]) -> str:
    counted = Counter(word for each in sentences if each.verdict for word in each.verdict.wrong)
    return ", ".join(f"{name} {n}" for name, n in counted.most_common()) or "nothing"


def _median(walks: Sequence[Walk], sure: bool) -> float:
    """Median of the metres; a walk that is told nothing counts whole."""
    first = [walk.first_m(sure) for walk in walks]
    return median(
        walk.length_m if each is None else each for each, walk in zip(first, walks, strict=True)
    )


def main(arguments: Sequence[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    seeds = range(options.seed, options.seed + options.walks)
    try:
        if options.results:
            around("voice", options.results)
        walks = list(walked(seeds, options.jobs))
    except PalmsError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    for each in (each for walk in walks for each in walk.about_place if _is_false(each)):
        assert each.verdict is not None
        print(f"false: seed {each.seed}, {each.time_s:.0f} s, off by {each.error_m:.1f} m, "
              f"{', '.join(each.verdict.wrong)}: {each.saying.text} {each.saying.details}",
              file=sys.stderr)  # fmt: skip
    text = f"{table(walks)}\n\nSeeds {seeds[0]} to {seeds[-1]}; {machine_words()}."
    if options.results:
        put("voice", text, options.results)
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
