"""A second generator of cases for the diagnosis, which shares no code with the first; see README.md."""
