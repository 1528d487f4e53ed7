"""A dataset with a sensor of a user's own, whose file is not loaded: `symolo repair` restores all but its readings."""

import pytest

from sensors.registry import SENSORS
from tests.contracts.test_own_sensor import TOY
from tests.release_fixtures import ONE_ROUTE

RUN = "CW/test_1"
TABLES = (f"{RUN}/data.csv", f"{RUN}/side/feeler.csv", f"{RUN}/side/tof.csv", f"{RUN}/side/wheels.csv")
SETTINGS = (ONE_ROUTE, "stop.time_limit_s=0.2", "rates.camera_hz=0", "robot.sensors.feeler={}", "robot.sensors.imu={}")


@pytest.fixture(scope="module")
def released(tmp_path_factory):
    from pipeline.cli import main  # noqa: PLC0415 - as a user, with the file before the command

    place = tmp_path_factory.mktemp("own")
    (place / "feeler.py").write_text(TOY)
    settings = [word for setting in SETTINGS for word in ("--set", setting)]
    out = place / "data"
    words = ["--sensor-file", str(place / "feeler.py"), "release", "smoke", *settings, "--workers", "1"]
    assert main([*words, "--out", str(out)]) == 0
    for file in [*SENSORS.files.values()]:
        SENSORS.unload(file.path)
    return out


def damaged(root, names=TABLES):
    for name in names:
        (root / name).write_bytes(b"damaged")
    return root


def test_all_tables_come_back_from_the_trajectory(released, copy_of, symolo, release_of):
    """The description in metadata.json states their columns and digits."""
    root = damaged(copy_of(released, stages=True), (*TABLES, f"{RUN}/side/imu.csv"))
    assert symolo("repair", root).code == 0
    assert release_of(root) == release_of(released)
    assert not SENSORS.files


def test_without_the_description_those_of_known_sensors_come_back(released, copy_of, symolo):
    root = damaged(copy_of(released, stages=True), (*TABLES, f"{RUN}/side/imu.csv", "metadata.json"))
    (root / ".stages/assemble/metadata.json").unlink()
    ended = symolo("repair", root)
    left = [line for line in ended.out.splitlines() if line.startswith("not repaired: ")]
    assert ended.code == 4
    assert [line.split(": ")[1] for line in left] == [f"{RUN}/side/feeler.csv", "metadata.json"]
    assert "its file feeler.py (" in left[0]


def test_a_run_without_a_trajectory_is_simulated_without_the_sensor(released, copy_of, symolo):
    root = damaged(copy_of(released), (*TABLES, f"{RUN}/side/imu.csv"))
    ended = symolo("repair", root)
    left = [line for line in ended.out.splitlines() if line.startswith("not repaired: ")]
    assert (ended.code, len(left)) == (4, 1)
    assert f"{RUN}/side/feeler.csv: was changed" in left[0]
    assert "; sensor feeler: its file feeler.py (" in left[0]
    assert "symolo --sensor-file feeler.py" in left[0]
    for name in (f"{RUN}/data.csv", f"{RUN}/side/imu.csv", f"{RUN}/side/tof.csv", f"{RUN}/side/wheels.csv"):
        assert (root / name).read_bytes() == (released / name).read_bytes()
    assert not SENSORS.files
