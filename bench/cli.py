"""The command line of ``python -m bench``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence

from bench import ladder, promises
from bench.effort import Effort, TopicFailedError
from bench.figures import Figure
from bench.machine import machine
from bench.registry import TOPICS, chosen
from bench.report import as_json, as_markdown, missed, table

EXIT_MISSED = 1
EXIT_USAGE = 2
COMPARING: dict[str, Callable[[Sequence[str]], int]] = {"ladder": ladder.main, "promises": promises.main}


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and return 1 if a figure misses its limit, 2 for a wrong call, else 0."""
    words = sys.argv[1:] if arguments is None else arguments
    if words and words[0] in COMPARING:  # with an earlier commit: other options, no topic
        return COMPARING[words[0]](words[1:])
    parser = _parser()
    given = parser.parse_args(words)
    try:
        names = chosen(tuple(given.names))
    except KeyError as error:
        parser.print_usage(sys.stderr)
        print(f"bench: no topic {error.args[0]!r}; there are: {', '.join(TOPICS)}", file=sys.stderr)
        return EXIT_USAGE
    if given.runs < 1:
        print("bench: --runs must be at least 1", file=sys.stderr)
        return EXIT_USAGE
    effort = Effort(given.runs, given.quick)
    results = measure_all(names, effort, lambda name: print(f"measuring: {name}", file=sys.stderr, flush=True))
    show = as_json if given.json else as_markdown if given.markdown else table
    print(show(results, machine()))
    return EXIT_MISSED if missed(results) else 0


def measure_all(names: Sequence[str], effort: Effort, tell: Callable[[str], object]) -> dict[str, list[Figure]]:
    """Return the figures of the topics; one that fails leaves a line with the reason, and the others continue."""
    results: dict[str, list[Figure]] = {}
    for name in names:
        tell(name)
        try:
            results[name] = TOPICS[name].load()(effort)
        except TopicFailedError as error:
            results[name] = [Figure(TOPICS[name].help, "", (), note=str(error), failed=True)]
    return results


def _parser() -> argparse.ArgumentParser:
    width = max(map(len, TOPICS))
    topics = "\n".join(f"  {name.ljust(width)}  {topic.help}" for name, topic in TOPICS.items())
    parser = argparse.ArgumentParser(
        prog="python -m bench",
        description="Measure what the software costs on this machine. Exit code 1 when a figure misses its limit.",
        epilog=f"topics:\n{topics}\n\npython -m bench ladder --against COMMIT: speed beside an earlier version\n"
        "python -m bench promises --against COMMIT: what was to be gained over it",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="topics to measure (default: all)")
    shown = parser.add_mutually_exclusive_group()
    shown.add_argument("--json", action="store_true", help="one JSON object instead of the table")
    shown.add_argument("--markdown", action="store_true", help="the table in Markdown, as in docs/performance.md")
    parser.add_argument("--source", action="store_true", help="measure this checkout, not what is installed")
    parser.add_argument("--quick", action="store_true", help="short measurements, for a look")
    parser.add_argument("--runs", type=int, default=3, metavar="N", help="runs of every figure (default 3)")
    return parser
