"""A release as what is uploaded to an archive: tar shards, and what people and machines know it by."""
