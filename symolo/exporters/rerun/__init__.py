"""Format of Rerun: an .rrd file that its viewer opens."""
