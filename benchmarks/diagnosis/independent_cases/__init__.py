"""Cases with known truth for the diagnosis of the gap between a robot and its nominal simulation; see README.md."""
