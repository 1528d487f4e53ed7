"""Make cases, or grade answers."""

import argparse
import sys
from pathlib import Path

from benchmarks.diagnosis.independent_cases import judge
from benchmarks.diagnosis.other_robots.cases import KINDS, make_cases
from benchmarks.diagnosis.other_robots.compiled import NoCompilerError
from benchmarks.diagnosis.other_robots.files import write_case, write_truth


def main() -> None:
    """Make cases with --kind and --out, or grade answers with --truth and --answers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kind", choices=sorted(KINDS))
    parser.add_argument("--cases", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="folder of the cases and of truth.json")
    parser.add_argument("--truth", type=Path, help="truth.json of the cases")
    parser.add_argument("--answers", type=Path, help="folder of the answers")
    args = parser.parse_args()
    if args.truth and args.answers:
        judge.run(args.truth, args.answers)
    elif args.kind and args.out:
        try:
            for case in make_cases(args.kind, args.cases, args.seed):
                write_case(args.out / case.truth["case"], case)
                write_truth(args.out / "truth.json", case.truth)
        except NoCompilerError as error:
            print(error, file=sys.stderr)
            sys.exit(2)
    else:
        parser.error("give --kind and --out to make cases, or --truth and --answers to grade answers")


if __name__ == "__main__":
    main()
