"""bag-info.txt of a release, in the format of BagIt (RFC 8493, section 2.2.2): amount of data, program, processors."""

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from symolo.core.errors import one_line
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.versions import versions

BAG_INFO, DECLARATION = "bag-info.txt", "bagit.txt"
CPU_CLASS, OXUM = "CPU-Class", "Payload-Oxum"


def bag_info(name: str, description: str, sizes: Mapping[str, int], cpu_classes: Iterable[str]) -> bytes:
    """Return the file. It has no date, so that the same data give the same bytes.

    Args:
        name: Name of the dataset.
        description: Description, in one line or several.
        sizes: Size [bytes] of each file of the payload.
        cpu_classes: Classes of the processors that made the dataset; "" is an unknown class.
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
    """Return the classes of processors that a bag-info.txt names."""
    text = info.decode("utf-8", errors="replace")
    return tuple(one_line(value) for value in re.findall(rf"^{CPU_CLASS}: (.*)$", text, re.MULTILINE))


def read_cpu_classes(root: Path) -> tuple[str, ...]:
    """Return the classes of the processors that made a dataset; none if its bag-info.txt is missing."""
    try:
        return cpu_classes(read_file(root / BAG_INFO, FileKind.DOCUMENT))
    except OSError:
        return ()
