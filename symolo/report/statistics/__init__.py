"""The numbers that the release report shows, gathered before the page is written."""
