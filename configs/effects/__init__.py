"""The base class of effects, the table of all effects, and the effects of one robot."""
