"""`symolo verify` names the file and the fault of every kind of damage, also where the checksums were written again."""

import errno
import hashlib
import json
import os
import re
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from pipeline.cli import main
from pipeline.run_folder.stored_spec import spec_problem
from symolo.core.files import image_decoder
from symolo.verification.verify import verify

RUN = "CW/test_1"
CSV = f"{RUN}/data.csv"


def edit(name, change):
    def damage(root: Path):
        path = root / name
        text = path.read_text()
        changed = change(text)
        assert changed != text
        path.write_text(changed)

    return damage


def cell(column, row, value):
    """Puts `value` into one cell of data.csv; row 0 is the first below the header."""

    def change(text):
        lines = text.splitlines()
        cells = lines[row + 1].split(",")
        cells[lines[0].split(",").index(column)] = value
        lines[row + 1] = ",".join(cells)
        return "\n".join(lines) + "\n"

    return edit(CSV, change)


def scaled(column, factor):
    """A column in another unit."""

    def change(text):
        header, *rows = (line.split(",") for line in text.splitlines())
        at = header.index(column)
        for row in rows:
            row[at] = f"{float(row[at]) * factor:.6f}"
        return "\n".join(",".join(row) for row in (header, *rows)) + "\n"

    return edit(CSV, change)


def metadata(change):
    def damage(root):
        path = root / "metadata.json"
        content = json.loads(path.read_text())
        change(content)
        path.write_text(json.dumps(content))

    return damage


def remove(name):
    return lambda root: (root / name).unlink()


def cut(name, keep):
    return lambda root: (root / name).write_bytes((root / name).read_bytes()[:keep])


def another_size(root):
    cv2.imwrite(str(root / RUN / "images/000002.jpg"), np.zeros((48, 64, 3), np.uint8))


def swap(first, second):
    def damage(root):
        one, two = (root / RUN / first).read_bytes(), (root / RUN / second).read_bytes()
        (root / RUN / first).write_bytes(two)
        (root / RUN / second).write_bytes(one)

    return damage


def without_line(number):
    return lambda text: "".join(line for i, line in enumerate(text.splitlines(keepends=True)) if i != number)


def half_of_it(text):
    return text[: len(text) // 2]


CONTENT = {
    "byte-order mark": (
        lambda root: (root / CSV).write_bytes(b"\xef\xbb\xbf" + (root / CSV).read_bytes()),
        CSV,
        "begins with a byte-order mark",
    ),
    "line ends of Windows": (
        lambda root: (root / CSV).write_bytes((root / CSV).read_bytes().replace(b"\n", b"\r\n")),
        CSV,
        "has line ends of Windows",
    ),
    "csv missing": (remove(CSV), CSV, "cannot be read"),
    "csv empty": (cut(CSV, 0), CSV, "is empty"),
    "csv cut in a row": (edit(CSV, half_of_it), CSV, "cut off"),
    "csv is binary": (lambda root: (root / CSV).write_bytes(b"\xff\xfe\x00"), CSV, "is UTF-16 text"),
    "column renamed": (
        edit(CSV, lambda t: t.replace("theta", "thta", 1)),
        CSV,
        "column thta is not known.*did you mean theta",
    ),
    "columns swapped": (edit(CSV, lambda t: t.replace("t,x,y", "t,y,x", 1)), CSV, "another order"),
    "semicolons": (edit(CSV, lambda t: t.replace(",", ";")), CSV, "one column: got"),
    "not a number": (cell("v", 3, "fast"), CSV, "line 5: column v: got 'fast', allowed: a number"),
    "nan": (cell("d_f", 0, "nan"), CSV, "line 2: column d_f: got 'nan'"),
    "infinite": (cell("w", 9, "-inf"), CSV, "line 11: column w: got '-inf'"),
    "state with a fraction": (cell("state", 1, "0.5"), CSV, "column state: got '0.5', allowed: a whole number"),
    "unknown state": (cell("state", 1, "7"), CSV, "line 3: column state: 7 is none of 0, 1, 2"),
    "time stands still": (cell("t", 4, "150"), CSV, "line 6: column t: 150 ms is not after 150 ms"),
    "time shifted": (cell("t", 4, "210"), CSV, "line 6: column t: 210 ms does not keep 20 Hz"),
    "row missing": (edit(CSV, without_line(7)), CSV, "20 rows, metadata.json says 21"),
    "time in seconds": (scaled("t", 1e-3), CSV, "column t"),
    "position in millimetres": (scaled("y", 1000), CSV, "line 3: columns x, y: .* m is a jump"),
    "coordinate in millimetres": (scaled("x", 1000), CSV, r"\(550, -0.2\) m is not the start"),
    "position jumps": (cell("y", 8, "0.9"), CSV, "line 10: columns x, y: 1.* m is a jump"),
    "theta in degrees": (scaled("theta", 57.29578), CSV, "rad is outside -pi..pi"),
    "speed in millimetres": (scaled("v", 1000), CSV, "beyond what the robot can do"),
    "speed in centimetres": (scaled("v", 10), CSV, "column v adds up to"),
    "speed without sign of turn": (cell("w", 5, "31"), CSV, "line 7: column w: 31 rad/s"),
    "range in millimetres": (scaled("d_l", 1000), CSV, "column d_l: 2000 m is outside 0.04..1.2"),
    "range below the least": (cell("d_r", 2, "0.0390"), CSV, "line 4: column d_r: 0.039 m"),
    "reflectance above one": (cell("L7", 2, "1.2"), CSV, "line 4: column L7: 1.2 is outside 0..1"),
    "reflectance negative": (cell("L0", 2, "-0.01"), CSV, "column L0"),
    "image number repeated": (cell("img", 4, "1"), CSV, "column img: 1 does not count up from 1"),
    "image at another row": (cell("img", 2, "9"), CSV, "column img: 9 does not keep 5 Hz"),
    "image removed": (remove(f"{RUN}/images/000004.jpg"), f"{RUN}/images", "000004.jpg is missing"),
    "image added": (
        lambda root: (root / RUN / "images/000099.jpg").write_bytes((root / RUN / "images/000001.jpg").read_bytes()),
        f"{RUN}/images",
        "000099.jpg is not named in data.csv",
    ),
    "image cut": (cut(f"{RUN}/images/000005.jpg", 400), f"{RUN}/images/000005.jpg", "not a whole JPEG"),
    "image empty": (cut(f"{RUN}/images/000005.jpg", 0), f"{RUN}/images/000005.jpg", "not a whole JPEG"),
    "image without a body": (
        lambda root: (root / RUN / "images/000005.jpg").write_bytes(b"\xff\xd8\xff\xe0 nothing \xff\xd9"),
        f"{RUN}/images/000005.jpg",
        "cannot be decoded",
    ),
    "image of another size": (another_size, f"{RUN}/images/000002.jpg", "is 64 x 48 px, metadata.json says 32 x 24"),
    "position changed": (
        edit(f"{RUN}/image_positions.txt", lambda t: t.replace("1 0.550000", "1 0.550001")),
        f"{RUN}/image_positions.txt",
        "line 2: is not the pose of image 1",
    ),
    "position missing": (
        edit(f"{RUN}/image_positions.txt", without_line(3)),
        f"{RUN}/image_positions.txt",
        "5 positions for 6 images",
    ),
    "positions with commas": (
        edit(f"{RUN}/image_positions.txt", lambda t: t.replace(" ", ",")),
        f"{RUN}/image_positions.txt",
        "one column: got 'img,x,y,theta', allowed: img x y theta",
    ),
    "side file of another run": (
        edit(f"{RUN}/side/wheels.csv", lambda t: t.replace("\n50,", "\n51,")),
        f"{RUN}/side/wheels.csv",
        "column t is not that of data.csv",
    ),
    "side file missing": (remove(f"{RUN}/side/tof.csv"), f"{RUN}/side/tof.csv", "cannot be read"),
    "intrinsics of another lens": (
        edit(f"{RUN}/side/intrinsics.json", lambda t: t.replace('"D": [\n    0.0', '"D": [\n    0.1')),
        f"{RUN}/side/intrinsics.json",
        "D is not that of the camera in spec.json",
    ),
    "camera elsewhere": (
        edit(f"{RUN}/side/camera.csv", lambda t: re.sub(r"0\.120000", "0.120100", t, count=1)),
        f"{RUN}/side/camera.csv",
        "line 2: column p_z: 0.1201 is not that",
    ),
    "intrinsics missing": (remove(f"{RUN}/side/intrinsics.json"), f"{RUN}/side/intrinsics.json", "cannot be read"),
    "scene cut": (cut(f"{RUN}/side/scene.json", 90), f"{RUN}/side/scene.json", "Invalid JSON"),
    "furniture without a place": (
        edit(f"{RUN}/side/scene.json", lambda t: t.replace('"x_m"', '"x"', 1)),
        f"{RUN}/side/scene.json",
        "furniture.0.x_m: Field required",
    ),
    "intrinsics cut": (cut(f"{RUN}/side/intrinsics.json", 90), f"{RUN}/side/intrinsics.json", "Invalid JSON"),
    "intrinsics of other pictures": (
        edit(f"{RUN}/side/intrinsics.json", lambda t: t.replace('"width_px": 32', '"width_px": 64')),
        f"{RUN}/side/intrinsics.json",
        "is of images of 64 x 24 px, metadata.json says 32 x 24",
    ),
    "a specification that is none": (
        edit(f"{RUN}/side/spec.json", lambda text: re.sub(r'("focal_length_mm": ?)[0-9.]+', r"\g<1>0.0", text)),
        f"{RUN}/side/spec.json",
        r"robot\.camera\.focal_length_mm: Input should be",
    ),
    "specification cut": (cut(f"{RUN}/side/spec.json", 100), f"{RUN}/side/spec.json", "cannot be read"),
    "metadata missing": (remove("metadata.json"), "metadata.json", "cannot be read"),
    "metadata is no JSON": (cut("metadata.json", 50), "metadata.json", "Invalid JSON"),
    "metadata with another field": (metadata(lambda m: m.update(extra=1)), "metadata.json", "extra"),
    "metadata without a rate": (
        metadata(lambda m: m["runs"][0].pop("rates")),
        "metadata.json",
        "runs.0: rates: missing",
    ),
    "metadata of more rows": (metadata(lambda m: m["runs"][0].update(rows=22)), CSV, "21 rows, metadata.json says 22"),
    "metadata leads outside": (metadata(lambda m: m["runs"][0].update(run="../x")), "metadata.json", "leads out of"),
    "run folder added": (lambda root: (root / "CW/test_2").mkdir(), "CW/test_2", "is not named in metadata.json"),
    "run folder gone": (lambda root: (root / RUN).rename(root / "CW/test_9"), RUN, "the folder is missing"),
    "description missing": (remove("README.md"), "README.md", "is missing"),
}

UNSIGNED = {
    "one bit of an image": (
        lambda root: _flip_bit(root / RUN / "images/000003.jpg"),
        f"{RUN}/images/000003.jpg",
        "was changed",
    ),
    "images swapped": (
        swap("images/000001.jpg", "images/000002.jpg"),
        f"{RUN}/images/000002.jpg",
        f"it was swapped with {RUN}/images/000001.jpg",
    ),
    "image copied over another": (
        lambda root: shutil.copy(root / RUN / "images/000001.jpg", root / RUN / "images/000002.jpg"),
        f"{RUN}/images/000002.jpg",
        f"it holds what {RUN}/images/000001.jpg should hold",
    ),
    "file emptied": (cut(f"{RUN}/side/spec.json", 0), f"{RUN}/side/spec.json", "it is empty"),
    "file copied": (
        lambda root: shutil.copy(root / CSV, root / "CW/data.csv"),
        "CW/data.csv",
        f"is not named in manifest-sha256.txt; it is a copy of {CSV}",
    ),
    "bag-info edited": (edit("bag-info.txt", lambda t: t.replace("CPU", "GPU")), "bag-info.txt", "was changed"),
    "link instead of a file": (
        lambda root: (remove(CSV)(root), (root / CSV).symlink_to("../../CCW/test_1/data.csv")),
        CSV,
        "symbolic link",
    ),
    "pipe added": (lambda root: os.mkfifo(root / "CW/pipe"), "CW/pipe", "is a pipe, and a dataset holds plain files"),
    "file added": (lambda root: (root / "CW/notes.txt").write_text("x"), "CW/notes.txt", "is not named in"),
    "file removed": (remove(f"{RUN}/side/camera.csv"), f"{RUN}/side/camera.csv", "is missing"),
    "description edited": (edit("README.md", str.upper), "README.md", "was changed"),
    "manifest removed": (remove("manifest-sha256.txt"), "manifest-sha256.txt", "is missing"),
    "manifest cut": (cut("manifest-sha256.txt", 100), "manifest-sha256.txt", "line 2 is not a checksum"),
    "manifest twice": (edit("manifest-sha256.txt", lambda t: t + t), "manifest-sha256.txt", "is not a checksum"),
    "checksum edited": (
        edit("manifest-sha256.txt", lambda t: re.sub(rf"[0-9a-f]{{8}}  {CSV}", f"00000000  {CSV}", t)),
        "manifest-sha256.txt",
        f"not as released is its entry for {CSV}",
    ),
    "checksum removed": (
        edit("manifest-sha256.txt", without_line(2)),
        "manifest-sha256.txt",
        "not as released is its entry for CCW/test_1/images/000001.jpg",
    ),
    "name edited in the manifest": (
        edit("manifest-sha256.txt", lambda t: t.replace(f"  {CSV}", f"  {RUN}/date.csv")),
        "manifest-sha256.txt",
        f"not as released is its entry for {CSV} and 1 more",
    ),
    "checksum of the manifest edited": (
        edit("tagmanifest-sha256.txt", lambda t: re.sub(r"[0-9a-f]{8}  man", "00000000  man", t)),
        "tagmanifest-sha256.txt",
        "does not fit manifest-sha256.txt",
    ),
    "checksum of bag-info edited": (
        edit("tagmanifest-sha256.txt", lambda t: re.sub(r"[0-9a-f]{8}  bag", "00000000  bag", t)),
        "tagmanifest-sha256.txt",
        "does not fit manifest-sha256.txt",
    ),
    "checksum of the manifest gone": (
        edit("tagmanifest-sha256.txt", without_line(1)),
        "tagmanifest-sha256.txt",
        "does not name manifest-sha256.txt",
    ),
    "tag manifest removed": (remove("tagmanifest-sha256.txt"), "tagmanifest-sha256.txt", "is missing"),
}


def _flip_bit(path):
    data = bytearray(path.read_bytes())
    data[-20] ^= 4
    path.write_bytes(data)


def test_a_dataset_as_released_has_no_fault(dataset):
    assert list(verify(dataset)) == []


@pytest.mark.parametrize("kind", CONTENT)
def test_damage_is_found_by_content(kind, dataset, copy_of, sign):
    damage, file, what = CONTENT[kind]
    root = copy_of(dataset)
    damage(root)
    sign(root)
    findings = [str(finding) for finding in verify(root, spec_problem)]
    assert any(text.startswith(f"{file}: ") and re.search(what, text) for text in findings), findings


@pytest.mark.parametrize("kind", UNSIGNED)
def test_damage_is_found_by_checksum(kind, dataset, copy_of):
    damage, file, what = UNSIGNED[kind]
    root = copy_of(dataset)
    damage(root)
    findings = [str(finding) for finding in verify(root)]
    assert any(text.startswith(f"{file}: ") and what in text for text in findings), findings
    other = [text for text in findings if not text.startswith(f"{file}: ")]
    assert other == [] or kind == "images swapped", "files that are as they were released are not blamed"


def test_a_release_of_a_version_without_scene_json_has_no_fault(dataset, copy_of, sign):
    out = copy_of(dataset)
    for path in out.rglob("side/scene.json"):
        path.unlink()
    sign(out)
    assert list(verify(out)) == []


def test_a_file_under_another_name_is_reported_with_both(dataset, copy_of):
    root = copy_of(dataset)
    (root / CSV).rename(root / "CW/moved.csv")
    assert [str(finding) for finding in verify(root)] == [
        f"CW/moved.csv: is not named in manifest-sha256.txt; it is what {CSV} should be",
        f"{CSV}: is missing; manifest-sha256.txt names it; its content is now named CW/moved.csv",
    ]


def test_a_missing_file_is_one_fault_with_a_list_of_checksums_or_without(dataset, copy_of):
    root = copy_of(dataset)
    (root / CSV).unlink()
    assert [str(finding) for finding in verify(root)] == [f"{CSV}: is missing; manifest-sha256.txt names it"]
    (root / "manifest-sha256.txt").unlink()
    (root / "tagmanifest-sha256.txt").unlink()
    assert f"{CSV}: cannot be read: No such file or directory" in [str(finding) for finding in verify(root)]


def test_a_manifest_under_another_name_is_reported_with_both(dataset, copy_of):
    root = copy_of(dataset)
    (root / "manifest-sha256.txt").rename(root / "manifest-sha256.old")
    assert {finding.file for finding in verify(root)} == {"manifest-sha256.txt", "manifest-sha256.old"}


@pytest.mark.parametrize("stages", [True, False])
@pytest.mark.parametrize("other", ["README.md", "tagmanifest-sha256.txt"])
def test_a_file_that_was_swapped_with_the_manifest_is_reported_with_it(dataset, copy_of, stages, other):
    root = copy_of(dataset, stages=stages)
    swap(f"../../{other}", "../../manifest-sha256.txt")(root)
    assert {finding.file for finding in verify(root)} == {other, "manifest-sha256.txt"}


def test_an_edited_file_and_an_edited_checksum_are_both_reported_where_the_stages_are_there(dataset, copy_of):
    """Neither list fits the other any more; what was assembled tells which file it was."""
    root = copy_of(dataset, stages=True)
    cell("v", 3, "0.123456")(root)
    digest = hashlib.sha256((root / CSV).read_bytes()).hexdigest()
    edit("manifest-sha256.txt", lambda t: re.sub(rf"[0-9a-f]{{64}}  {CSV}", f"{digest}  {CSV}", t))(root)
    findings = [str(finding) for finding in verify(root)]
    assert f"manifest-sha256.txt: was changed: not as released is its entry for {CSV}" in findings
    assert any(text.startswith(f"{CSV}: was changed: its SHA-256") for text in findings)
    assert {text.partition(": ")[0] for text in findings} == {"manifest-sha256.txt", CSV}


def test_an_edit_with_all_checksums_made_again_is_reported_where_the_stages_are_there(dataset, copy_of, sign):
    root = copy_of(dataset, stages=True)
    cell("v", 3, "0.123456")(root)
    sign(root)
    assert f"{CSV}: fits its checksum, but is not what was assembled: both were edited" in map(str, verify(root))


def test_a_file_that_the_disk_does_not_give_is_named_and_the_others_are_checked(dataset, copy_of, monkeypatch):
    root = copy_of(dataset)
    cell("L3", 0, "1.5")(root)
    lost = root / RUN / "images/000004.jpg"
    opened = os.open

    def open_or_fail(path, *args, **options):
        if path == lost:
            raise OSError(errno.EIO, os.strerror(errno.EIO), str(path))
        return opened(path, *args, **options)

    monkeypatch.setattr(os, "open", open_or_fail)
    findings = [str(finding) for finding in verify(root)]
    assert f"{RUN}/images/000004.jpg: cannot be read: {os.strerror(errno.EIO)}" in findings
    assert f"{CSV}: line 2: column L3: 1.5 is outside 0..1" in findings


def test_names_that_would_upset_a_terminal_are_shown_in_one_line(dataset, copy_of, symolo):
    root = copy_of(dataset)
    (root / "CW/\x1b[2J\nCCW: fine").write_text("x")
    os.close(os.open(os.fsencode(root) + b"/CW/\xff", os.O_CREAT))
    ended = symolo("verify", root)
    assert ended.code == 4
    assert len(ended.out.splitlines()) == 2
    assert "\x1b" not in ended.out


def test_the_command_names_the_faults_and_ends_with_four(dataset, copy_of, symolo):
    root = copy_of(dataset)
    assert symolo("verify", root).code == 0
    cell("L3", 0, "1.5")(root)
    ended = symolo("verify", root)
    assert ended.code == 4
    assert f"{CSV}: line 2: column L3: 1.5 is outside 0..1" in ended.out.splitlines()


def test_many_faults_of_a_kind_are_summed_up(dataset, copy_of, sign):
    root = copy_of(dataset)
    scaled("theta", 57.29578)(root)
    sign(root)
    findings = [finding.what for finding in verify(root) if "theta" in finding.what or "of this kind" in finding.what]
    assert len([text for text in findings if text.startswith("line")]) == 5
    assert "and 16 more of this kind" in findings


def test_what_libjpeg_says_of_damaged_pixels_is_not_on_the_terminal(dataset, copy_of, capfd):
    root = copy_of(dataset)
    path = root / RUN / "images/000001.jpg"
    data = bytearray(path.read_bytes())
    middle = len(data) - 60
    data[middle : middle + 40] = b"\xff\xd0" * 20  # restart markers where none belong
    path.write_bytes(data)
    image = cv2.imdecode(np.frombuffer(bytes(data), np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    assert "Corrupt JPEG" in capfd.readouterr().err, "libjpeg does say something"
    assert main(["verify", str(root)]) == 4
    output = capfd.readouterr()
    assert f"{RUN}/images/000001.jpg" in output.out
    assert output.err == f"{root}: 1 fault\n"


CRASHING = """
import os, signal
import cv2, numpy as np
import symolo.core.files.image_decoder_child as child

def decode(data, flags):
    if b"this file" in data:
        os.kill(os.getpid(), signal.{signal})
    return cv2.imdecode(np.frombuffer(data, np.uint8), flags)

child.serve(decode)
"""
"""A decoder that ends at a certain file."""


@pytest.fixture
def ended_by(monkeypatch, dataset, copy_of, sign):
    """A dataset with fitting lists in which a file ends the decoder by a signal."""
    root, decoders = copy_of(dataset), []
    path = root / RUN / "images/000001.jpg"
    data = path.read_bytes()
    path.write_bytes(data[:2] + b"\xff\xfe\x00\x0bthis file" + data[2:])  # a comment (ITU-T T.81, B.2.4.5)
    sign(root)

    def prepare(signal):
        decoders.append(image_decoder.ImageDecoder(CRASHING.format(signal=signal)))
        monkeypatch.setattr(image_decoder, "_shared", lambda: decoders[-1])
        return root

    yield prepare
    for decoder in decoders:
        decoder.close()


def test_a_file_that_crashes_the_decoder_is_a_fault_and_the_others_are_checked(ended_by, symolo):
    ended = symolo("verify", ended_by("SIGSEGV"))
    assert ended.code == 4
    assert ended.out.splitlines() == [f"{RUN}/images/000001.jpg: cannot be decoded"]


def test_where_the_system_ends_the_decoder_nothing_is_called_a_fault(ended_by, symolo):
    ended = symolo("verify", ended_by("SIGKILL"))
    assert ended.code == 5
    assert ended.out == ""
    assert ended.err.count("\n") == 1
    assert "there is not enough memory: images are decoded in a child process" in ended.err


def test_a_folder_that_is_no_dataset_is_named_so(tmp_path, symolo):
    (tmp_path / "notes.txt").write_text("nothing of symolo\n")
    ended = symolo("verify", tmp_path)
    assert (ended.code, ended.out) == (2, "")
    assert "is no dataset: there is no metadata.json, no manifest-sha256.txt and no run in it" in ended.err
