"""One kind of sensor on the nominal robot in short drives."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.scenario import RunSpec
from pipeline.executors.local import Local
from pipeline.rules import BrokenRule
from pipeline.run_folder.first_stage import read_recording
from pipeline.stages.simulate import simulate
from pipeline.stages.simulate_runs import simulation_key
from pipeline.work.units import SimulateUnit
from sensors.base import Reading, Sensor
from symolo.core.files.scratch_folders import scratch_folder
from symolo.core.tables.time_series import Recording
from symolo.dataset.tables.sensor_tables import SERIES

DRIVE_S = 2.0
SHORT_S = 0.2
SECOND = "second_one"
"""Name of a further sensor of the kind."""


@dataclass(frozen=True)
class SensorTrial:
    """A kind of sensor with its default settings."""

    kind: type[Sensor]

    def spec(self, *settings: str, duration_s: float = DRIVE_S) -> RunSpec:
        """Return a drive of the scenario `smoke` with some settings."""
        shared = (f"stop.time_limit_s={duration_s}", "rates.camera_hz=0", "stop.lap=false")
        return draw_run(load_scenario("smoke", (*shared, *settings)), "CW", 1)

    @property
    def setting(self) -> str:
        return f"robot.sensors.{self.kind.name}={{}}"

    def series(self, recording: Recording, name: str = "") -> Reading:
        """Return the readings (samples, columns) of a sensor of the kind."""
        return recording[SERIES.format(name=name or self.kind.name)].values

    @cached_property
    def bare(self) -> Mapping[str, Reading]:
        """Series of the drive without the sensor."""
        return {series.name: series.values for series in simulate(self.spec()).recording.series}

    @cached_property
    def recording(self) -> Recording:
        """The drive with the sensor."""
        return simulate(self.spec(self.setting)).recording

    def in_new_process(self) -> Reading:
        """Return the readings of the same drive in a process of its own, as in a release."""
        spec = self.spec(self.setting)
        with scratch_folder() as scratch:
            folder = Path(scratch) / "run"
            unit = SimulateUnit(name=spec.key, spec=spec.model_dump_json(), folder=folder, key=simulation_key(spec))
            for failure in Local(1).do([unit], lambda *_: None):
                raise BrokenRule(failure.text)
            return self.series(read_recording(folder))
