"""The SyMoLo dataset on disk: tables, description, metadata, checksums."""
