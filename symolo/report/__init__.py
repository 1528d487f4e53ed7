"""A release as one HTML page for people, made from the release alone."""
