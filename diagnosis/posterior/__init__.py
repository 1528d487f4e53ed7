"""The joint posterior of all numbers of a robot, as a file from which datasets are drawn."""
