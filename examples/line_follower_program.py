r"""A controller as a program of its own: it reads and writes lines of JSON, and needs nothing of symolo.

symolo --controller-command "python3 examples/line_follower_program.py" \
    simulate smoke --set "arena.obstacles=[]" --out data
"""

import json
import sys

SPEED_M_S = 0.18
GAIN_RAD_S = 0.9


def answer(message: dict) -> None:
    print(json.dumps(message), flush=True)


threshold = json.loads(sys.stdin.readline())["robot"]["line_sensor"]["threshold"]
answer({"ready": True})
offset = 0.0
for line in sys.stdin:
    seen = json.loads(line)
    dark = [channel - 3.5 for channel, reflectance in enumerate(seen["line"]) if reflectance < threshold]
    if dark:
        offset = sum(dark) / len(dark)
    v_m_s = SPEED_M_S * (1.0 - abs(offset) / 7.0)
    answer({"tick": seen["tick"], "v_m_s": v_m_s, "w_rad_s": GAIN_RAD_S * offset})
