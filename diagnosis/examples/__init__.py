"""Small measured cases of each kind, made by a simulation with hidden effects, and the list of their answers."""
