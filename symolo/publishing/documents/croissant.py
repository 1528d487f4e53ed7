"""croissant.json: files, tables and columns in MLCommons' Croissant 1.1, so that `mlcroissant` loads the records.

The format: http://mlcommons.org/croissant/1.1. The package mlcroissant 1.1.1 would write the same document from as
many objects as there are dicts here, but `symolo pack` would then need scipy, rdflib, networkx and requests.
"""

from typing import Any

from symolo.dataset.layout import IMAGES
from symolo.dataset.tables.column import single
from symolo.publishing.about import Author
from symolo.publishing.dataset import PackedFile, Published
from symolo.publishing.documents.responsible_ai import RAI_CONFORMS_TO, responsible_ai
from symolo.publishing.membership import RUN_REGEX, Membership
from symolo.publishing.tables import RUN, PlannedTable

CONFORMS_TO = "http://mlcommons.org/croissant/1.1"
_TERMS = (
    "arrayShape citeAs column containedIn equivalentProperty extract field fileObject fileProperty fileSet format "
    "includes isArray isLiveDataset jsonPath key md5 parentField path recordSet references regex repeated replace "
    "samplingRate separator source subField transform"
)
"""Terms of Croissant's vocabulary; readers require all of them in the context, used or not."""
_CONTEXT: dict[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "sc": "https://schema.org/",
    "cr": "http://mlcommons.org/croissant/",
    "rai": "http://mlcommons.org/croissant/RAI/",
    "dct": "http://purl.org/dc/terms/",
    "conformsTo": "dct:conformsTo",
    "data": {"@id": "cr:data", "@type": "@json"},
    "examples": {"@id": "cr:examples", "@type": "@json"},
    "name": {"@container": "@language"},
    "description": {"@container": "@language"},
} | {name: f"cr:{name}" for name in _TERMS.split()}
_CONTEXT["dataType"] = {"@id": "cr:dataType", "@type": "@vocab"}

IMAGE_FILES = "image-files"


def croissant(data: Published) -> dict[str, Any]:
    """Return the content of the file."""
    about = data.about
    document: dict[str, Any] = {
        "@context": _CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": [CONFORMS_TO, RAI_CONFORMS_TO],
        "name": about.title,
        "alternateName": data.name,
        "description": data.description,
        "license": data.licence.url or data.licence.name,
        "creator": [_creator(author) for author in about.authors],
        "publisher": {"@type": "sc:Organization", "name": about.publisher},
        "datePublished": about.published,
        "version": about.version,
        "keywords": list(data.keywords),
        "citeAs": about.citation,
        "isLiveDataset": False,
        "distribution": [
            *(_file(shard, "application/x-tar") for shard in data.shards),
            *(_file(file, "text/csv") for file, _ in data.described_tables),
        ],
        "recordSet": [_rows(table, data) for table, _ in data.tables],
    }
    if membership := data.membership:
        document["recordSet"] += membership.record_sets()
    if any(run.images for run in data.metadata.runs):
        document["distribution"].append(_image_files(data))
        document["recordSet"].append(_images(membership))
    return document | responsible_ai(data.metadata) | ({"url": about.address} if about.address else {})


def _creator(author: Author) -> dict[str, str]:
    kind = "sc:Person" if author.given else "sc:Organization"
    return {"@type": kind, "name": author.name} | ({"url": author.orcid_url} if author.orcid else {})


def _file(file: PackedFile, encoding: str) -> dict[str, Any]:
    return {
        "@type": "cr:FileObject",
        "@id": file.name,
        "name": file.name,
        "contentUrl": file.name,
        "contentSize": f"{file.size} B",
        "encodingFormat": encoding,
        "sha256": file.sha256,
    }


def _image_files(data: Published) -> dict[str, Any]:
    archives = [{"@id": shard.name} for shard in data.shards]
    return {
        "@type": "cr:FileSet",
        "@id": IMAGE_FILES,
        "name": IMAGE_FILES,
        "containedIn": archives if len(archives) > 1 else archives[0],
        "encodingFormat": "image/jpeg",
        "includes": _image_patterns(data),
    }


def _image_patterns(data: Published) -> str | list[str]:
    """Return the patterns of the images of the camera of data.csv.

    A `*` of these patterns stands for several folders too, so that one pattern for all runs would include the images
    of further cameras.
    """
    if not any(run.cameras for run in data.metadata.runs):
        return f"{data.name}/*/*/{IMAGES}/*.jpg"
    return [f"{data.name}/{run.run}/{IMAGES}/*.jpg" for run in data.metadata.runs]


def _rows(table: PlannedTable, data: Published) -> dict[str, Any]:
    file = {"fileObject": {"@id": table.file}}
    fields = [_field(table.name, RUN, "for example CW/test_1", "sc:Text", file | {"extract": {"column": RUN}})]
    for column in single(one.column for one in data.metadata.columns[table.source]):
        text = f"{column.meaning or column.name} [{column.unit}]"
        source = file | {"extract": {"column": column.name}}
        fields.append(_field(table.name, column.name, text, table.kinds[column.name], source))
    return {
        "@type": "cr:RecordSet",
        "@id": table.name,
        "name": table.name,
        "description": f"{table.source} of every run",
        "field": fields,
    }


def _images(membership: Membership | None) -> dict[str, Any]:
    files = {"fileSet": {"@id": IMAGE_FILES}}
    # The first folder of a path is that of the dataset; the next two name the run.
    run = {"extract": {"fileProperty": "fullpath"}, "transform": {"regex": RUN_REGEX}}
    number = {"extract": {"fileProperty": "filename"}, "transform": {"regex": r"0*(\d+)\.jpg$"}}
    content = {"extract": {"fileProperty": "content"}}
    fields = [
        _field(IMAGES, RUN, "for example CW/test_1", "sc:Text", files | run),
        _field(IMAGES, "img", "number of the image", "sc:Integer", files | number),
        _field(IMAGES, "image", "the image", "sc:ImageObject", files | content),
    ]
    if membership:
        split_fields = membership.fields_of_images(files | {"extract": {"fileProperty": "fullpath"}})
        names = {field["name"] for field in split_fields}
        fields = [*(field for field in fields if field["name"] not in names), *split_fields]
    return {
        "@type": "cr:RecordSet",
        "@id": IMAGES,
        "name": IMAGES,
        "description": "Every image; the table `camera` has time and pose of the image with its run and number.",
        "field": fields,
    }


def _field(table: str, name: str, text: str, kind: str, source: dict[str, Any]) -> dict[str, Any]:
    return {
        "@type": "cr:Field",
        "@id": f"{table}/{name}",
        "name": name,
        "description": text,
        "dataType": kind,
        "source": source,
    }
