"""Sentences about the whole diagnosis: what is wrong, what stays unexplained, and what the effects gain."""
