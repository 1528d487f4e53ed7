"""The plots of the release report."""
