"""datacite.json: the dataset in DataCite's metadata schema 4.5, with which archives register a DOI.

The package datacite 1.4.1 checks and sends such records but does not build them; tests check ours with its schema.
"""

from typing import Any

from symolo.core.progress import plural
from symolo.publishing.about import Author
from symolo.publishing.dataset import Published

SCHEMA = "http://datacite.org/schema/kernel-4"
_SPDX, _ORCID = "https://spdx.org/licenses/", "https://orcid.org"


def datacite(data: Published) -> dict[str, Any]:
    """Return the attributes of the record; doi and url only if they are known."""
    about, runs = data.about, data.metadata.runs
    record: dict[str, Any] = {
        "schemaVersion": SCHEMA,
        "types": {"resourceType": data.contents.resource_type, "resourceTypeGeneral": "Dataset"},
        "titles": [{"title": about.title, "lang": "en"}],
        "creators": [_creator(author) for author in about.authors],
        "publisher": {"name": about.publisher},
        "publicationYear": str(about.year),
        "dates": [{"date": about.published, "dateType": "Issued"}],
        "language": "en",
        "version": about.version,
        "subjects": [{"subject": keyword} for keyword in data.keywords],
        "descriptions": [{"description": data.description, "descriptionType": "Abstract", "lang": "en"}],
        "rightsList": [_rights(data)],
        "sizes": [f"{sum(shard.size for shard in data.shards)} bytes", plural(len(runs), "run")],
        "formats": ["application/x-tar", "text/csv"],
    }
    if any(run.images for run in runs):
        record["formats"].append("image/jpeg")
    if any(run.annotations for run in runs):
        record["formats"].append("image/png")
    return record | ({"doi": about.doi} if about.doi else {}) | ({"url": about.url} if about.url else {})


def _creator(author: Author) -> dict[str, Any]:
    creator: dict[str, Any] = {"name": author.name, "nameType": "Organizational"}
    if author.given:
        creator |= {"nameType": "Personal", "givenName": author.given, "familyName": author.family}
    if author.orcid:
        creator["nameIdentifiers"] = [
            {"nameIdentifier": author.orcid_url, "nameIdentifierScheme": "ORCID", "schemeUri": _ORCID}
        ]
    if author.affiliation:
        creator["affiliation"] = [{"name": author.affiliation}]
    return creator


def _rights(data: Published) -> dict[str, str]:
    licence = data.licence
    if not licence.known:
        return {"rights": licence.name}
    spdx = {"rightsIdentifier": licence.spdx, "rightsIdentifierScheme": "SPDX", "schemeUri": _SPDX}
    return {"rights": licence.name, "rightsUri": licence.url, **spdx}
