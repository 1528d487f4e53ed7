"""The pages of docs that are written by the code: commands, settings, effects, materials, formats.

python docs/generate            write them
python docs/generate --check    exit 1 and name those that are not what the code says
"""

import argparse
import sys

from pages import DOCS, drifted, write


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing")
    if not parser.parse_args().check:
        write()
        return 0
    stale = drifted()
    for page in stale:
        print(f"{DOCS.name}/{page} is not what the code says; run: python docs/generate", file=sys.stderr)
    return int(bool(stale))


if __name__ == "__main__":
    sys.exit(main())
