"""The rigid robot: links, inertia, model files, and many robots as arrays."""
