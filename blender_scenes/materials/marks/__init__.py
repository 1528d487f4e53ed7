"""Traces of use and the patterns that they are made of: dirt, stains, specks and streaks."""
