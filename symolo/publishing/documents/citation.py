"""CITATION.cff: how to cite the dataset, in the Citation File Format 1.2.0."""

from typing import Any

import yaml

from symolo.publishing.about import Author
from symolo.publishing.dataset import Published


def citation(data: Published) -> bytes:
    about = data.about
    content: dict[str, Any] = {
        "cff-version": "1.2.0",
        "message": "If you use this dataset, please cite it as below.",
        "type": "dataset",
        "title": about.title,
        "authors": [_author(author) for author in about.authors],
        "version": about.version,
        "date-released": about.published,
        "abstract": data.description,
        "keywords": list(data.keywords),
    }
    if data.licence.known:  # the format takes identifiers of SPDX only
        content["license"] = data.licence.spdx
    if about.doi:
        content["doi"] = about.doi
    if about.url:
        content["url"] = about.url
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120).encode()


def _author(author: Author) -> dict[str, str]:
    if author.given is None:
        entry = {"name": author.family}  # an organisation, which has no affiliation in this format
    else:
        entry = {"family-names": author.family, "given-names": author.given}
    if author.orcid:
        entry["orcid"] = author.orcid_url
    if author.given and author.affiliation:
        entry["affiliation"] = author.affiliation
    return entry
