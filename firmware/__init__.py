"""The controller in C for an ATmega2560; `physics.hil.build` compiles it. See docs/firmware.md."""
