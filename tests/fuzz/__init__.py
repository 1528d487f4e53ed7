"""Readers of files from strangers, and inputs that they have to refuse in one line, at once and without a traceback."""
