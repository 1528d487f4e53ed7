"""Errors of the nominal and the extended robot in PyBullet, driven open loop by the measured voltages."""
