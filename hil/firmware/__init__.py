"""The controller in C for an ATmega2560; `hil.build` compiles it. See docs/hil.md."""
