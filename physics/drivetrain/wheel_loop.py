"""The wheel-speed controller on the robot's board: encoder counts in, motor voltage out, one per wheel."""

from math import copysign, pi

from configs.schema.robot import Encoder, Power, WheelLoop


class WheelSpeedLoop:
    """Feed-forward plus PI on the filtered encoder speed, with the output limit known to the integrator."""

    def __init__(self, loop: WheelLoop, encoder: Encoder, power: Power, rate_hz: int) -> None:
        self._loop = loop
        self._period_s = 1.0 / rate_hz
        self._rad_s_per_count = 2.0 * pi / encoder.counts_per_revolution * rate_hz
        self._smoothing = self._period_s / (self._period_s + loop.speed_filter_s)
        self._limit_V = voltage_limit_V(power)
        self.restart(0)

    def restart(self, counts: int) -> None:
        """Start again at these encoder counts, as for a wheel at rest."""
        self._counts = counts
        self._integral_V = 0.0
        self.speed_rad_s = 0.0
        """Speed as the board measures it."""

    def update(self, counts: int, set_point_rad_s: float) -> float:
        """Return the voltage [V] until the next update."""
        turned = counts - self._counts
        self._counts = counts
        self.speed_rad_s += self._smoothing * (turned * self._rad_s_per_count - self.speed_rad_s)
        if set_point_rad_s == 0.0 and turned == 0:
            # Friction holds the wheel at rest; the remaining integral must not make it creep.
            self._integral_V = 0.0
            return 0.0
        loop, limit = self._loop, self._limit_V
        error = set_point_rad_s - self.speed_rad_s
        feed_forward = loop.feedforward_V_s_rad * set_point_rad_s
        if set_point_rad_s != 0.0:
            feed_forward += copysign(loop.feedforward_static_V, set_point_rad_s)
        voltage = feed_forward + loop.proportional_V_s_rad * error + self._integral_V
        clipped = min(max(voltage, -limit), limit)
        # At a limit the integral may only change away from it.
        if voltage == clipped or (voltage - clipped) * error < 0.0:
            self._integral_V += loop.integral_V_rad * error * self._period_s
        return clipped


def voltage_limit_V(power: Power) -> float:
    """Return the largest voltage that the H-bridge applies to a motor, in either direction."""
    return min(power.battery_voltage_V, power.motor_voltage_limit_V)
