"""What the documents state about imported logs, about images along their trajectories, and about simulated runs."""

import hashlib
import json
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml

from pipeline.cli import main
from symolo.dataset.documents.contents import Contents
from symolo.dataset.documents.metadata import Metadata, read_metadata
from symolo.dataset.documents.origin import Origin, ReleaseOrigin
from symolo.publishing.about import read_about
from symolo.publishing.dataset import PackedFile, Published
from symolo.publishing.documents.card import card
from symolo.publishing.documents.citation import citation
from symolo.publishing.documents.croissant import croissant
from symolo.publishing.documents.datacite import datacite
from symolo.publishing.documents.provenance import provenance
from symolo.publishing.documents.ro_crate import ro_crate

SIMULATED_WORDS = (
    "simulated",
    "synthetic data",
    "pybullet",
    "computed, not measured",
    "data sheet",
    "from the scenario",
)
RENDERED_WORDS = ("path-traced", "rendered", "synthetic images", "blender")
SHARD = PackedFile("data-00000.tar", 1, "00" * 32)


@pytest.fixture(scope="module")
def imported(tmp_path_factory):
    """A log of two seconds along +x, and the dataset that `import` made of it."""
    folder = tmp_path_factory.mktemp("recorded")
    log = folder / "drive 1.csv"
    log.write_text("\n".join(["time_s,x_m,y_m,yaw_rad", *(f"{0.1 * i:.1f},{0.03 * i:.3f},0,0" for i in range(21))]))
    assert main(["import", str(log), "--out", str(folder / "data")]) == 0
    return SimpleNamespace(log=log, root=folder / "data")


@pytest.fixture
def documents(about):
    """Return the text of each document about metadata, without files."""

    def texts_of(metadata: Metadata) -> dict[str, str]:
        data = Published(read_about(about), metadata, (), (SHARD,))
        made = {"croissant.json": croissant(data), "datacite.json": datacite(data), "crate": ro_crate(data)}
        texts = {name: json.dumps(content) for name, content in made.items()}
        return texts | {"README.md": card(data).decode(), "CITATION.cff": citation(data).decode()}

    return texts_of


def claims(text: str, words: tuple[str, ...]) -> list[str]:
    """Return the words that a text claims; that something is not simulated is no claim."""
    plain = " ".join(text.lower().replace("not simulated", "").replace("were not simulated", "").split())
    plain = plain.replace("synthetic dataset for mobile robots", "").replace("look of rendered images", "")
    return [word for word in words if word in plain]


def with_images(metadata: Metadata) -> Metadata:
    """Return the metadata of the same trajectories with five rendered images in each run."""
    release = ReleaseOrigin(name=metadata.name, manifest_sha256="ab" * 32, run="imported/test_1")
    runs = [
        run.model_copy(update={"images": 5, "origin": Origin(log=run.origin and run.origin.log, release=release)})
        for run in metadata.runs
    ]
    return metadata.model_copy(update={"runs": runs, "made_with": {**metadata.made_with, "bpy": "4.5.15"}})


def test_no_document_of_an_imported_log_says_that_anything_was_simulated_or_rendered(imported, documents):
    for name, text in documents(read_metadata(imported.root)).items():
        assert claims(text, SIMULATED_WORDS + RENDERED_WORDS) == [], name
        assert "Recorded robot trajectories" in text or name != "datacite.json"
        assert "dataset of recorded trajectories" in text, name


def test_images_along_an_imported_log_are_rendered_and_its_motion_is_not_simulated(imported, documents):
    for name, text in documents(with_images(read_metadata(imported.root))).items():
        assert claims(text, SIMULATED_WORDS) == [], name
        assert "the images are path-traced with Blender Cycles at its poses" in " ".join(text.split()), name
        assert "synthetic images" in text, name
    assert (
        "Recorded robot trajectories with rendered images"
        in documents(with_images(read_metadata(imported.root)))["datacite.json"]
    )


def test_a_simulated_release_is_synthetic_and_states_images_only_if_there_are_any(packed, documents):
    metadata = read_metadata(packed.release)
    without = [run.model_copy(update={"images": 0, "annotations": ()}) for run in metadata.runs]
    for text in documents(metadata).values():
        assert "synthetic data" in text
        assert "The motion is simulated with PyBullet; the images are path-traced" in " ".join(text.split())
    bare = documents(metadata.model_copy(update={"runs": without}))
    for name, text in bare.items():
        assert "and there are no images" in " ".join(text.split()), name
        assert "path-traced" not in text
    assert json.loads(bare["datacite.json"])["types"]["resourceType"] == "Simulated robot runs"


def test_the_pack_of_an_imported_log_names_the_log_and_promises_no_scenario(imported, about, tmp_path):
    out = tmp_path / "upload"
    assert main(["pack", str(imported.root), "--about", str(about), "--out", str(out)]) == 0
    digest, readme = hashlib.sha256(imported.log.read_bytes()).hexdigest(), (out / "README.md").read_text()
    assert "symolo import" in readme
    assert digest in readme
    assert "symolo release" not in readme
    assert "Workflow" not in readme
    assert not (out / "scenario.yaml").exists()
    settings = yaml.safe_load((out / "settings.yaml").read_text())
    assert settings == json.loads((imported.root / "metadata.json").read_bytes())["scenario"]
    graph = {one["@id"]: one for one in json.loads((out / "ro-crate-metadata.json").read_bytes())["@graph"]}
    assert graph["./"]["conformsTo"] == {"@id": "https://w3id.org/ro/wfrun/process/0.5"}
    assert "mainEntity" not in graph["./"]
    run = graph["#run"]
    assert (run["name"], graph[run["instrument"]["@id"]]["name"]) == ("symolo import", "symolo")
    assert graph[run["object"]["@id"]]["sha256"] == digest
    assert "ComputationalWorkflow" not in json.dumps(graph)


def test_images_along_the_trajectories_of_a_simulated_release_are_not_made_again_by_a_scenario(packed, documents):
    texts = documents(with_images(read_metadata(packed.release)))
    assert "synthetic data" in texts["CITATION.cff"]
    for name in ("README.md", "crate"):
        assert "symolo rerender" in texts[name]
        assert "symolo release" not in texts[name]
        assert "ab" * 32 in texts[name]


def test_images_of_a_log_are_not_rendered_and_may_show_persons(imported, documents):
    metadata = read_metadata(imported.root)
    camera = {
        "period_s": 0.5, "images": 4, "image_width_px": 32, "image_height_px": 24, "render_device": "",
    }  # fmt: skip
    runs = [run.model_dump(mode="json") | {"cameras": {"front": camera}} for run in metadata.runs]
    metadata = Metadata.model_validate(metadata.model_dump(mode="json") | {"runs": runs})
    contents = Contents.from_metadata(metadata)
    assert (contents.logged_images, contents.rendered_images, contents.render_devices) == (4, 0, ())
    texts = documents(metadata)
    for name, text in texts.items():
        assert claims(text, SIMULATED_WORDS + RENDERED_WORDS) == [], name
    assert (
        json.loads(texts["datacite.json"])["types"]["resourceType"]
        == "Recorded robot trajectories with recorded images"
    )
    (stated,) = json.loads(texts["croissant.json"])["rai:personalSensitiveInformation"]
    assert stated.startswith("Not known")


def test_keywords_of_the_author_replace_those_of_the_contents(imported, about, tmp_path):
    path = tmp_path / "about.yaml"
    path.write_text(Path(about).read_text() + "keywords: [dead reckoning]\n")
    data = Published(read_about(path), read_metadata(imported.root), (), ())
    assert json.loads(json.dumps(datacite(data)))["subjects"] == [{"subject": "dead reckoning"}]


def test_provenance_names_no_device_that_rendered_where_nothing_was_rendered(imported):
    statement = json.loads(provenance(imported.root, read_metadata(imported.root)))
    assert statement["predicate"]["buildDefinition"]["internalParameters"]["renderDevices"] == []


def test_report_and_card_for_the_hub_state_that_an_imported_log_was_recorded(imported, tmp_path):
    assert main(["report", str(imported.root), "--out", str(tmp_path / "report.html")]) == 0
    assert "Rendered on" not in (tmp_path / "report.html").read_text()
    assert main(["export", str(imported.root), "--format", "huggingface", "--out", str(tmp_path / "hub")]) == 0
    text = (tmp_path / "hub/huggingface/README.md").read_text()
    assert "dataset of recorded trajectories" in text
    assert "control period" not in text
    assert "`images`" not in text
