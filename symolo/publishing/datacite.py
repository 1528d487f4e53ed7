"""datacite.json: the dataset in the words of DataCite's metadata schema 4.5, as archives register it for a DOI."""

from typing import Any

from symolo.publishing.about import Author
from symolo.publishing.dataset import Published

SCHEMA = "http://datacite.org/schema/kernel-4"
_SPDX, _ORCID = "https://spdx.org/licenses/", "https://orcid.org"


def datacite(data: Published) -> dict[str, Any]:
    """The attributes of a record; doi and url only where they are told."""
    about = data.about
    found: dict[str, Any] = {
        "schemaVersion": SCHEMA,
        "types": {"resourceType": "Simulated robot runs with images", "resourceTypeGeneral": "Dataset"},
        "titles": [{"title": about.title, "lang": "en"}],
        "creators": [_creator(author) for author in about.authors],
        "publisher": {"name": about.publisher},
        "publicationYear": str(about.year),
        "dates": [{"date": about.published, "dateType": "Issued"}],
        "language": "en",
        "version": about.version,
        "subjects": [{"subject": keyword} for keyword in about.keywords],
        "descriptions": [{"description": data.description, "descriptionType": "Abstract", "lang": "en"}],
        "rightsList": [_rights(data)],
        "sizes": [f"{sum(shard.size for shard in data.shards)} bytes", f"{len(data.metadata.runs)} runs"],
        "formats": ["application/x-tar", "text/csv", *_pictures(data)],
    }
    return found | ({"doi": about.doi} if about.doi else {}) | ({"url": about.url} if about.url else {})


def _pictures(data: Published) -> list[str]:
    runs = data.metadata.runs
    jpeg, png = any(run.images for run in runs), any(run.annotations for run in runs)
    return ["image/jpeg"] * jpeg + ["image/png"] * png


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
