"""The plots of the diagnosis report."""
