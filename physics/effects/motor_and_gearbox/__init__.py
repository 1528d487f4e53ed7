"""Effects on the motors with their friction, and on the play of their gearboxes."""
