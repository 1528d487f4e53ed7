"""Exit codes of the commands; `symolo --help` lists them."""

BUG = 1
BAD_INPUT = 2
RUN_FAILED = 3
"""A run, an image or a case failed; the others are finished."""
FAULTS = 4
"""A dataset, or a copy of it, has faults."""
MACHINE_LACKS = 5
INTERRUPTED = 130
