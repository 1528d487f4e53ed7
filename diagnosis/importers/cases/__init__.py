"""Reading of measured cases, shared by the importers of their kinds."""
