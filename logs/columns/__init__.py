"""Columns of logs: the words by which they are named, the quantities that they hold, and a mapping of all of them."""
