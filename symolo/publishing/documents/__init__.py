"""Documents that describe a release: README.md, CITATION.cff, Croissant, DataCite, RO-Crate and provenance."""
