"""Units of columns: their names and factors, and what the values say about them."""
