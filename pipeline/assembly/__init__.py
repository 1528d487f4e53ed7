"""The documents that a release is written with."""
