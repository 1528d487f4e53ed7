"""Format of LeRobot: episodes in Parquet files, their statistics, and images as files or videos."""

from symolo.exporters.lerobot.exporter import EXPORTER

__all__ = ["EXPORTER"]
