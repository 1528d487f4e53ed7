"""The documents of a release: metadata, specifications of runs, camera and scene."""
