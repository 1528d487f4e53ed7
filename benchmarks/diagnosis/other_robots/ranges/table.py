"""Effects of a range bench: those of the format, and causes that no table of the format has."""

from benchmarks.diagnosis.other_robots.effects import Effect, Parameter, Table, factor, level, sized
from benchmarks.diagnosis.other_robots.ranges.bench import RangeBench


def named_table(b: RangeBench) -> Table:
    """Return the effects of the format on the mean, with plausible ranges for this bench."""
    reach = b.reach
    decay = Parameter("decay_length_m", 0.04 * reach, 0.25 * reach, log=True)
    time_constant = Parameter("time_constant_s", 0.07 * b.last, 0.5 * b.last, log=True)
    table = {
        "range_offset": sized("offset_m", -0.08, 0.08),
        "range_scale": factor(0.8, 1.25),
        "log_range_error": sized("coefficient_m", -0.05 * reach, 0.05 * reach),
        "temperature_drift": sized("coefficient_m_per_K", -0.003, 0.003),
        "incidence_bias": sized("coefficient", -0.25, 0.25),
        "cover_crosstalk": sized("strength_per_m2", 0.0005, 0.4),
        "near_field_error": sized("amplitude_m", -0.06, 0.06, decay),
        "range_saturation": level("saturation_m", 0.45 * reach, 0.9 * reach),
        "warmup_drift": sized("amplitude_m", -0.08, 0.08, time_constant),
    }
    if len(b.reflectance) > 1:
        materials = ("material", tuple(b.reflectance))
        table["material_bias"] = Effect((Parameter("offset_m", -0.1, 0.1),), discrete=materials)
        table["material_slope"] = Effect((Parameter("coefficient", -0.2, 0.2),), discrete=materials)
    return table


def outside_table(b: RangeBench) -> Table:
    """Return causes that no table of the format has, of those that move the mean."""
    reach = b.reach
    centre = Parameter("centre", 0.25 * reach, 0.7 * reach)
    period = Parameter("period", 0.12 * reach, 0.4 * reach, log=True)
    return {
        # the calibration table of the sensor has a kink: another slope beyond a distance
        "table_kink": sized("slope", -0.25, 0.25, Parameter("beyond", 0.35 * reach, 0.65 * reach)),
        # a second target beside the ray adds to the reading in a band of distances
        "second_target": sized("height", -0.12, 0.12, centre, Parameter("width", 0.03 * reach, 0.12 * reach)),
        # leakage in the phase measurement: an error periodic in distance
        "phase_ripple": sized("amplitude", 0.001, 0.04, period, Parameter("phase", 0, 6.28)),
        # readings are filtered: a share of the reading before remains
        "filtered_readings": sized("share", 0.002, 0.6),
        # readings come in coarse steps
        "coarse_steps": level("step", 0.006, 0.06),
        # the fixture moved: an offset from a moment on
        "bumped_fixture": sized("offset", -0.06, 0.06, Parameter("moment", 0.3 * b.last, 0.65 * b.last)),
        # bright light shifts the reading: an offset with the logarithm of the light
        "light_shift": sized("per_decade", -0.03, 0.03),
        # the scale (not the offset) depends on the temperature
        "scale_with_temperature": sized("per_kelvin", -0.004, 0.004),
        # a step of the gain: an offset on all readings beyond a distance
        "gain_switch": sized("jump", -0.06, 0.06, Parameter("beyond", 0.3 * reach, 0.7 * reach)),
        # the carriage of the target has play: an offset that depends on the direction from which it came
        "carriage_play": sized("play", 0.001, 0.05),
        # distances beyond the ambiguity distance fold back
        "fold_back": level("beyond", 0.6 * reach, 0.9 * reach),
        # the sensor has a smallest reading: nearer targets give that
        "nearest_reading": level("nearest", 0.12 * reach, 0.3 * reach),
        # a specular target at an angle: an offset beyond an angle, at all distances
        "reflection_at_angle": sized("offset", -0.08, 0.08, Parameter("angle", 0.25, 0.6)),
    }
