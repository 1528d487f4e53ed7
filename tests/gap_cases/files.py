"""The files of the format."""

from pathlib import Path

import numpy as np
import yaml

from .case import Case, Columns

DECIMALS = {
    "session_time_s": 4,
    "current_A": 6,
    "omega_rad_s": 5,
    "u_cmd_V": 4,
    "t_s": 4,
    "distance_m": 3,
    "incidence_rad": 4,
    "temperature_C": 1,
    "ambient_lux": 0,
    "reading_m": 3,
    "v_cmd_m_s": 3,
    "w_cmd_rad_s": 3,
    "u_left_V": 3,
    "u_right_V": 3,
    "enc_left_ticks": 0,
    "enc_right_ticks": 0,
    "tof_front_m": 3,
    "tof_left_m": 3,
    "tof_right_m": 3,
    "x_m": 4,
    "y_m": 4,
    "theta_rad": 4,
}
HEADERS = {
    "motor_steady": "row,sweep,split,t_s,u_cmd_V,current_A,omega_rad_s",
    "motor_step": "trial,split,session_time_s,t_s,u_cmd_V,current_A,omega_rad_s",
    "tof_bench": "row,split,t_s,distance_m,material,incidence_rad,temperature_C,ambient_lux,reading_m",
    "drive_log": (
        "trial,split,session_time_s,t_s,v_cmd_m_s,w_cmd_rad_s,u_left_V,u_right_V,enc_left_ticks,enc_right_ticks,"
        "tof_front_m,tof_left_m,tof_right_m,x_m,y_m,theta_rad"
    ),
}


def write(case: Case, folder: Path) -> None:
    """Make `folder` and write nominal.yaml, data.csv and the inputs of unseen runs into it; the truth stays outside."""
    folder.mkdir(parents=True, exist_ok=True)
    nominal = yaml.safe_dump(dict(case.bench.nominal), sort_keys=False)
    (folder / "nominal.yaml").write_text(nominal, encoding="utf-8", newline="\n")
    _write_csv(folder / "data.csv", case.columns, HEADERS[case.bench.kind].split(","))
    for name, inputs in case.blind.items():
        _write_csv(folder / name, inputs, list(inputs))


def _write_csv(path: Path, columns: Columns, names: list[str]) -> None:
    texts = [[_text(value, name) for value in columns[name].tolist()] for name in names]
    lines = [",".join(names), *(",".join(row) for row in zip(*texts, strict=True))]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def _text(value: float | str, name: str) -> str:
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.{DECIMALS[name]}f}"
    return str(value)
