"""Effects in what is read: bench instruments, pose log and range sensors."""

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
"""In the order of the signal chain, in which they act whatever the order in a file: what scales a reading comes before
what adds to it, and saturation last."""
