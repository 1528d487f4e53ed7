"""Sentences of the report about one topic each, and the words for numbers, units and effects."""
