"""Cases of the kind tof_bench."""
