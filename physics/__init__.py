"""The simulated physics: arena geometry, motor and body dynamics, the controller, trajectories."""
