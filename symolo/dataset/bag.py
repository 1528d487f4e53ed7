"""bag-info.txt of a release, in the form of BagIt (RFC 8493, section 2.2.2): how much it holds and what made it."""

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from symolo.core.errors import one_line
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.versions import versions

BAG_INFO, DECLARATION = "bag-info.txt", "bagit.txt"
CPU_CLASS, OXUM = "CPU-Class", "Payload-Oxum"


def bag_info(name: str, description: str, sizes: Mapping[str, int], cpu_classes: Iterable[str]) -> bytes:
    """The same bytes for the same data: it tells no day.

    Args:
        name: Of the dataset.
        description: In one line or several.
        sizes: Bytes of each file of the payload.
        cpu_classes: Of the processors that made it; one that is not known is "".
    """
    lines = [
        ("Bag-Software-Agent", f"symolo {versions('symolo')['symolo']}"),
        ("External-Identifier", name),
        ("External-Description", " ".join(one_line(description).split())),
        (OXUM, f"{sum(sizes.values())}.{len(sizes)}"),
        *((CPU_CLASS, cpu) for cpu in sorted({*cpu_classes} - {""})),
    ]
    return "".join(f"{label}: {value}\n" for label, value in lines if value).encode()


def cpu_classes(info: bytes) -> tuple[str, ...]:
    """What the lines of a bag-info.txt say of processors."""
    text = info.decode("utf-8", errors="replace")
    return tuple(one_line(value) for value in re.findall(rf"^{CPU_CLASS}: (.*)$", text, re.MULTILINE))


def read_cpu_classes(root: Path) -> tuple[str, ...]:
    """Of a dataset; nothing where it does not tell."""
    try:
        return cpu_classes(read_file(root / BAG_INFO, FileKind.DOCUMENT))
    except OSError:
        return ()
