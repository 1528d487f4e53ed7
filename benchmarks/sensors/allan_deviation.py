"""Allan deviation of the readings of an IMU at rest against the formula of docs/sensors.md.

The readings have all errors: noise, bias instability, random walk, fixed errors, and the rounding to 16 bits, which
adds white noise. The deviation is the overlapping one, over all axes and seeds. The bias follows the temperature, so
that `--warm-up-K` above 0 adds a ramp, which the formula does not have.

    python benchmarks/sensors/allan_deviation.py [--seconds 500] [--seeds 4] [--warm-up-K 0]
"""

import argparse

import numpy as np

from physics.robot.body_motion import BodyMotion
from sensors.inertial.imu import Imu, ImuSettings
from sensors.inertial.inertial_errors import ErrorSizes

TIMES_S = (0.005, 0.02, 0.1, 0.5, 2.0, 5.0, 10.0, 20.0)


class AtRest:
    """A world whose robot stands still."""

    time_s = 0.0

    def motion(self) -> BodyMotion:
        return BodyMotion(np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3))


def readings(settings: ImuSettings, seconds: float, seed: int) -> np.ndarray:
    """Return specific forces and angular rates (N, 6) at rest."""
    imu, world = Imu(settings, None, 1000, np.random.default_rng(seed)), AtRest()  # type: ignore[arg-type]
    rows = np.empty((round(seconds / settings.period_s), 6))
    for index in range(len(rows)):
        world.time_s = index * settings.period_s
        rows[index] = imu.sample(world)[:6]  # type: ignore[arg-type]
    return rows


def allan_variances(rows: np.ndarray, period_s: float) -> np.ndarray:
    """Return the overlapping Allan variance of each column at each time, (times, columns)."""
    total = np.concatenate([np.zeros((1, rows.shape[1])), np.cumsum(rows, axis=0)])
    variances = []
    for time_s in TIMES_S:
        n = round(time_s / period_s)
        change = (total[2 * n :] - 2.0 * total[n:-n] + total[: -2 * n]) / n
        variances.append(0.5 * np.mean(change**2, axis=0))
    return np.array(variances)


def expected(sizes: ErrorSizes, bits: int, period_s: float) -> np.ndarray:
    """Return the Allan deviation of the formula, with the noise of the rounding, at each time."""
    time_s, step = np.array(TIMES_S), 2.0 * sizes.range / 2**bits
    white = sizes.noise_density**2 + step**2 / 12.0 * period_s
    flicker, walk = 2.0 * np.log(2.0) / np.pi * sizes.bias_instability**2, sizes.random_walk**2 * time_s / 3.0
    return np.sqrt(white / time_s + flicker + walk)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=500.0)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--warm-up-K", dest="warm_up_K", type=float, default=0.0)
    arguments = parser.parse_args()
    settings = ImuSettings(warm_up_K=arguments.warm_up_K)
    variances = np.mean(
        [
            allan_variances(readings(settings, arguments.seconds, seed), settings.period_s)
            for seed in range(arguments.seeds)
        ],
        axis=0,
    )
    ratios = [
        np.sqrt(variances[:, columns].mean(axis=1)) / expected(sizes, settings.bits, settings.period_s)
        for columns, sizes in ((slice(3), settings.accelerometer.sizes()), (slice(3, 6), settings.gyroscope.sizes()))
    ]
    print("  time [s]  accelerometer  gyroscope (Allan deviation over that of the formula)")
    for time_s, force, rate in zip(TIMES_S, *ratios, strict=True):
        print(f"{time_s:10.3f}  {force:13.3f}  {rate:9.3f}")


if __name__ == "__main__":
    main()
