"""A Gymnasium environment over the simulation: `gymnasium.make("pipeline.gym:symolo/Drive-v0", scenario="symolo")`."""

from symolo.core.extras import optional_module

# Gymnasium imports the module before the colon, and expects it to register its environments.
optional_module("gymnasium").register("symolo/Drive-v0", entry_point="pipeline.gym.environment:DriveEnvironment")
