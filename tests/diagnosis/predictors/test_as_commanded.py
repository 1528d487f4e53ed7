"""What follows from the commands: free of the disturbances that a controller answers."""

import numpy as np

from diagnosis.predictors.wheels.as_commanded import as_commanded

ROWS = 800
TRIAL = np.repeat([1, 2], ROWS // 2)
SET_SPEED = np.where((np.arange(ROWS) // 40) % 2 == 0, 6.0, 12.0)


def voltage_of(disturbance):
    """Return the voltage (n,) of a first-order wheel, whose proportional controller sees a disturbed speed."""
    speed, voltage = np.zeros(ROWS), np.zeros(ROWS)
    for row in range(1, ROWS):
        voltage[row] = 0.5 * SET_SPEED[row] + 0.3 * (SET_SPEED[row] - speed[row - 1] - disturbance[row - 1])
        speed[row] = 0.7 * speed[row - 1] + 0.3 * 2.0 * voltage[row]
    return voltage


def test_what_follows_from_the_commands_knows_of_no_disturbance():
    """The voltage falls as the disturbance rises; its part from the commands does not, within three standard errors."""
    noise = np.random.default_rng(3).normal(0.0, 0.3, ROWS + 9)
    disturbance = np.convolve(noise, np.full(10, 0.3), mode="valid")
    undisturbed, voltage = voltage_of(np.zeros(ROWS)), voltage_of(disturbance)
    assert np.corrcoef(voltage - undisturbed, disturbance)[0, 1] < -0.7
    left = as_commanded(voltage, SET_SPEED, TRIAL) - undisturbed
    # Ten rows share a disturbance: a tenth of the rows are independent.
    assert abs(np.corrcoef(left, disturbance)[0, 1]) < 3.0 / np.sqrt(ROWS / 10)


def test_what_the_commands_determine_is_kept():
    """Without disturbances the voltage is a sum over the last commands, which least squares finds exactly."""
    weights = 0.5 ** np.arange(6)
    voltage = np.concatenate([np.convolve(SET_SPEED[trial == TRIAL], weights)[: ROWS // 2] for trial in (1, 2)])
    np.testing.assert_allclose(as_commanded(voltage, SET_SPEED, TRIAL), voltage, rtol=0.0, atol=1e-6)


def test_a_voltage_that_no_command_explains_stays_as_it_is():
    voltage = np.random.default_rng(4).normal(0.0, 2.0, ROWS)
    assert as_commanded(voltage, SET_SPEED, TRIAL) is voltage


def test_a_drive_without_logged_commands_stays_as_it_is():
    voltage = np.linspace(0.0, 5.0, ROWS)
    assert as_commanded(voltage, np.full(ROWS, np.nan), TRIAL) is voltage
