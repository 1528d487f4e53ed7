"""Hypotheses and their fits: parameters, likelihood, profiles and standard errors."""
