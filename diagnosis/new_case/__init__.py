"""A measured case from the log of any robot: columns under other names and in other units, and few known numbers."""
