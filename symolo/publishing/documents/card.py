"""README.md of a publication: a dataset card for people, with the front matter that the Hugging Face Hub reads."""

from typing import Any

import yaml

from symolo.dataset.documents.description import (
    columns_part,
    frames_part,
    markdown_table,
    plain_text,
    runs_part,
    splits_part,
)
from symolo.publishing.dataset import Published

_SIZES = ((1_000, "n<1K"), (10_000, "1K<n<10K"), (100_000, "10K<n<100K"), (1_000_000, "100K<n<1M"))
"""The Hub's size categories up to a million samples, each with the number below which it holds."""


def card(data: Published) -> bytes:
    """Return the file."""
    metadata = data.metadata
    parts = [_head(data), _files(data), _use(data), _remaking(data)]
    parts += [columns_part(metadata), frames_part(metadata), runs_part(metadata), splits_part(metadata)]
    parts.append(f"## Citation\n\n{plain_text(data.about.citation)}")
    front = yaml.safe_dump(_front_matter(data), sort_keys=False, allow_unicode=True, width=120)
    return (f"---\n{front}---\n\n" + "\n\n".join(part for part in parts if part) + "\n").encode()


def _front_matter(data: Published) -> dict[str, Any]:
    licence = data.licence
    images = sum(run.images for run in data.metadata.runs)
    size = next((name for limit, name in _SIZES if images < limit), "1M<n<10M")
    front: dict[str, Any] = {"pretty_name": data.about.title, "license": licence.hub}
    if licence.hub == "other":
        front["license_name"] = licence.spdx
    return front | {
        "task_categories": ["robotics"],
        "size_categories": [size],
        "tags": list(data.keywords),
        # The Hub shows these; left to itself it would take the shards for samples of WebDataset.
        "configs": [{"config_name": table.name, "data_files": table.file} for table, _ in data.tables],
    }


def _head(data: Published) -> str:
    about, licence = data.about, data.licence
    authors = "; ".join(
        plain_text(author.name) + (f" ([{author.orcid}]({author.orcid_url}))" if author.orcid else "")
        for author in about.authors
    )
    terms = f"[{plain_text(licence.name)}]({licence.url})" if licence.url else plain_text(licence.name)
    facts = f"Version {about.version}, {about.published}. {authors}. Licence: {terms}."
    return f"# {plain_text(about.title)}\n\n{plain_text(data.description)}\n\n{facts}"


def _files(data: Published) -> str:
    described = [(shard, f"the dataset, below `{data.name}/`") for shard in data.shards]
    described += data.described_tables
    rows = [(file.name, _size(file.size), text) for file, text in described]
    rows += [
        ("croissant.json", "", "files, tables and columns for MLCommons' `mlcroissant`"),
        ("datacite.json", "", "the record in DataCite's schema 4.5"),
        ("CITATION.cff", "", "how to cite it"),
        (data.remaking.settings_file, "", data.remaking.settings_meaning),
        ("ro-crate-metadata.json", "", f"how the dataset was made, as a {data.remaking.profile}"),
        ("SHA256SUMS", "", "checksums of all files here"),
    ]
    return f"## Files\n\n{markdown_table(('file', 'size', 'what it is'), rows)}"


def _remaking(data: Published) -> str:
    """Return how to make the dataset again from what is not in the folder; empty if its scenario is enough."""
    made = data.remaking
    if not made.steps:
        return ""
    listed = [(plain_text(source.name), source.what, source.sha256) for source in made.sources]
    return f"## Making it again\n\n{made.steps}\n\n{markdown_table(('name', 'what it is', 'SHA-256'), listed)}"


def _size(size_bytes: int) -> str:
    return f"{size_bytes / 1e6:.1f} MB" if size_bytes >= 1e6 else f"{size_bytes / 1e3:.1f} kB"


def _use(data: Published) -> str:
    return (
        "## Use\n\n"
        "    sha256sum -c SHA256SUMS\n"
        '    for shard in *.tar; do tar xf "$shard"; done\n'
        f"    cd {data.name} && sha256sum --quiet -c tagmanifest-sha256.txt manifest-sha256.txt\n\n"
        f"`{data.name}/README.md` describes layout, robot, arena and files of a run; with `symolo` installed,"
        f" `symolo verify {data.name}` checks the content too. With `pip install mlcroissant`:\n\n"
        "```python\n"
        "import mlcroissant\n\n"
        'for row in mlcroissant.Dataset("croissant.json").records("rows"):\n'
        '    print(row["rows/run"].decode(), row["rows/t"], row["rows/x"], row["rows/y"], row["rows/theta"])\n'
        "```"
    )
