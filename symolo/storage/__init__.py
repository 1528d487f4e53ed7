"""A release in an object store or a folder elsewhere: upload, comparison, download. One file for each kind of store."""
