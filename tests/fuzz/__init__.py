"""Readers of untrusted files, and inputs that they have to refuse in one line, at once and without a traceback."""
