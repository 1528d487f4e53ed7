"""Why simulation and measurement differ: identification of model parameters from measured data."""
