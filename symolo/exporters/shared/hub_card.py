"""README.md of an export for the Hugging Face Hub: front matter that names the files, and text for people."""

from collections.abc import Sequence

from symolo.dataset.documents.contents import Contents
from symolo.reader.dataset import Dataset


def hub_card(data: Dataset, front_matter: Sequence[str], text: Sequence[str] = ()) -> bytes:
    """Return the file: licence and lines of front matter in YAML, then name, description, origin and further text."""
    metadata = data.metadata
    licence = [f"license: {metadata.licence.lower()}"] if metadata else []
    name, description = (metadata.name, metadata.description) if metadata else (data.root.name, "")
    lines = ["---", *licence, *front_matter, "---", f"# {name}"]
    lines += ["", description] if description else []
    lines += ["", Contents.from_metadata(metadata).summary] if metadata else []
    lines += ["", *text] if text else []
    return ("\n".join(lines) + "\n").encode()
