"""A release in the form in which an archive takes it: tar shards, tables and documents."""
