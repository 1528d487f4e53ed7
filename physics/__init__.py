"""What happens: arena geometry, motor and body dynamics, the controller, trajectories."""
