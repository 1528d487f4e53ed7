"""Effects on the readings of bench instruments, of the pose log and of range sensors."""

EFFECTS = (
    "current_sensor_gain",
    "current_sensor_offset",
    "speed_scale",
    "speed_filter_lag",
    "speed_time_offset",
    "range_scale",
    "tof_range_scale",
    "cover_crosstalk",
    "log_range_error",
    "temperature_drift",
    "material_bias",
    "incidence_bias",
    "near_field_error",
    "warmup_drift",
    "range_offset",
    "tof_range_offset",
    "range_saturation",
    "noise_scale",
    "ambient_noise",
    "tof_mount_yaw",
    "tof_time_offset",
    "marker_offset",
    "pose_time_offset",
)
"""Modules of this folder, one effect each, in the order in which they act: scaling of a reading comes before addition,
and saturation last."""
