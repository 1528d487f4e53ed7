"""The kit for HTML pages, plots and contact sheets that all reports share."""
