"""Make cases, grade answers, or state what could be seen in cases."""

import argparse
from pathlib import Path

from benchmarks.diagnosis.independent_cases import bound, judge
from benchmarks.diagnosis.independent_cases.beyond import WORSE
from benchmarks.diagnosis.independent_cases.case import KINDS, make_cases
from benchmarks.diagnosis.independent_cases.files import write_case, write_truth


def main() -> None:
    """Make cases with --kind and --out, grade answers with --truth and --answers, or state the bound with --truth."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kind", choices=sorted(KINDS))
    parser.add_argument("--cases", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="folder of the cases and of truth.json")
    parser.add_argument("--again", action="store_true", help="also make each measurement again, with other noise")
    parser.add_argument(
        "--beyond", choices=sorted(WORSE), help="make one kind of disturbance larger than usual in all cases"
    )
    parser.add_argument(
        "--truth",
        type=Path,
        help="truth.json of the cases; alone, for the share of effects that an ideal test would see",
    )
    parser.add_argument("--answers", type=Path, help="folder of the answers")
    args = parser.parse_args()
    if args.truth and args.answers:
        judge.run(args.truth, args.answers)
    elif args.truth:
        bound.run(args.truth)
    elif args.kind and args.out:
        if args.beyond and args.kind not in {"motor_steady", "tof_bench"}:
            parser.error("--beyond changes benches only: motor_steady and tof_bench")
        for files, again, truth in make_cases(args.kind, args.cases, args.seed, WORSE.get(args.beyond)):
            write_case(args.out / truth["case"], files)
            if args.again:
                write_case(args.out / f"{truth['case']}_again", again)
            write_truth(args.out / "truth.json", truth)
    else:
        parser.error("give --kind and --out to make cases, --truth and --answers to grade answers, or --truth alone")


if __name__ == "__main__":
    main()
