"""Format of Rerun: an .rrd file that its viewer opens."""

from symolo.exporters.rerun.exporter import EXPORTER

__all__ = ["EXPORTER"]
