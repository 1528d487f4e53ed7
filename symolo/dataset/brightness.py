"""Limits from which an image counts as black or overexposed, for the exposure guard and the report."""

BLACK_UP_TO, BURNT_FROM = 16, 250
"""Grey values of 8 bits between which pixels show differences of light; 16 is the black of video (ITU-R BT.601)."""
MAX_BLACK, MAX_BURNT = 0.25, 0.10
"""Largest shares of black and of overexposed pixels in a good image. A dark tape is brighter than `BLACK_UP_TO`, and
the exposure itself keeps the share of overexposed pixels below a twentieth."""
