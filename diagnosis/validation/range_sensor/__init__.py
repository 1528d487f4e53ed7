"""The bench of the range sensor: the paper's five experiments, and real scans (paper section 5.2)."""
