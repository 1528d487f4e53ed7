"""Before and after by the engine itself: robots driven open loop in PyBullet by what was measured."""
