"""The quantities of a drive with two wheels, by the words with which logs name them."""

from logs.columns.quantity import DUTY as _DUTY
from logs.columns.quantity import LEFT, LINEAR, RIGHT, SET, TURNING, Quantity, words

VOLTAGE = words("u voltage volt volts motor mot vm umot spannung motorspannung tension") | _DUTY
COUNT_WORDS = words(
    "enc encoder encoders ticks tick counts count cnt pulses steps impulse denc dticks dcounts dcount dcnt"
)
PER_ROW = words("delta deltas diff inc increment increments change denc dticks dcounts dcount dcnt")
"""Words for counts since the row before."""
COUNTED = ("enc_left_ticks", "enc_right_ticks")
"""Quantities that are counts of encoders."""

WHEELS = (
    Quantity("enc_left_ticks", (LEFT, COUNT_WORDS), beside=PER_ROW),
    Quantity("enc_right_ticks", (RIGHT, COUNT_WORDS), beside=PER_ROW),
    Quantity("u_left_V", (LEFT, VOLTAGE)),
    Quantity("u_right_V", (RIGHT, VOLTAGE)),
)
COMMANDS = (Quantity("v_cmd_m_s", (SET, LINEAR)), Quantity("w_cmd_rad_s", (SET, TURNING)))
DRIVE_TABLE = "drive"
"""Name of the table `side/drive.csv` of an imported run with these quantities."""
