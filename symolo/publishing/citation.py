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
        "keywords": list(about.keywords),
    }
    if data.licence.known:  # any other identifier the format would not take
        content["license"] = data.licence.spdx
    if about.doi:
        content["doi"] = about.doi
    if about.url:
        content["url"] = about.url
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120).encode()


def _author(author: Author) -> dict[str, str]:
    if author.given is None:
        entity = {"name": author.family, "orcid": author.orcid_url if author.orcid else None}
        return {key: value for key, value in entity.items() if value}
    person = {
        "family-names": author.family,
        "given-names": author.given,
        "orcid": author.orcid_url if author.orcid else None,
        "affiliation": author.affiliation,
    }
    return {key: value for key, value in person.items() if value}
