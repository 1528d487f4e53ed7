"""Parameters of every effect that can be wrong in a robot; one section for each, one table for all."""
