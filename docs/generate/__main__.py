"""The pages of docs that are generated from the code: commands, settings, effects, materials, formats,
results as JSON.

python docs/generate            write the pages
python docs/generate --check    write nothing; name the pages that differ from the code, and exit with 1
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
        print(f"{DOCS.name}/{page} is missing or differs from the code; run: python docs/generate", file=sys.stderr)
    return int(bool(stale))


if __name__ == "__main__":
    sys.exit(main())
