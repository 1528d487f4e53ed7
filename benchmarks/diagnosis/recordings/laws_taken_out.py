"""Recordings whose effect is known, diagnosed without this effect in the list: does a law describe it?

    python -m benchmarks.diagnosis.recordings.laws_taken_out --recordings DIR

The weighting of the rays of a VL53L0X (a scan over a round object, `range_signal_weighting`), and the bridge of a
micromouse that lets the motor coast (steady speeds of both wheels in two sets, `bridge_coast`).
"""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import process_time

from benchmarks.diagnosis.recordings.real_benches import SETS, SIDES
from configs.effects.base import Effect
from diagnosis.diagnose import diagnose
from diagnosis.discovery.discover import with_law
from diagnosis.importers import micromouse
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.holdout import select_part
from diagnosis.measured.measurement import Measurement
from diagnosis.report.sentences.effects.discovered import sentences
from physics.effects.driver_and_battery.bridge_coast import BridgeCoast
from pipeline.diagnosing.importers import IMPORTERS
from sensors.effects.range_sensor.range_signal_weighting import RangeSignalWeighting


def main() -> None:
    """Print the law of each recording, with and without the effect in the list."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--recordings", type=Path, required=True, help="folder of the recordings")
    args = parser.parse_args()
    for name, measurement, effect in recordings(args.recordings):
        print(f"{name}, with all effects: {', '.join(diagnose(measurement).names) or 'nothing named'}", flush=True)
        begin = process_time()
        with taken_out(effect):
            diagnosis = with_law(diagnose(measurement))
        print(
            f"{name}, without {effect.name} ({process_time() - begin:.0f} CPU seconds): {diagnosis.conclusion}",
            flush=True,
        )
        print(f"  named {', '.join(diagnosis.names) or 'nothing'}")
        for text in sentences(diagnosis.discovery):
            print(f"  {text}", flush=True)


def recordings(folder: Path) -> Iterator[tuple[str, Measurement, type[Effect]]]:
    """Yield the recordings with the effect that each of them has."""
    for path in sorted((folder / "tof_vl53l0x_scan").glob("*.csv")):
        yield path.stem, read_measurement(path, IMPORTERS), RangeSignalWeighting
    for number in SETS:
        both = micromouse.IMPORTER.read(folder / "opatiny_micromouse" / f"wheelSpeedCalibration{number}.csv")
        for wheel in SIDES:
            yield f"set {number}, {wheel}", select_part(both, wheel), BridgeCoast


@contextmanager
def taken_out(effect: type[Effect]) -> Iterator[None]:
    """Have the diagnosis not look for an effect until the context ends."""
    setups, effect.setups = effect.setups, ()
    try:
        yield
    finally:
        effect.setups = setups


if __name__ == "__main__":
    main()
