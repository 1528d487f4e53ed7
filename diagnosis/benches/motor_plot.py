"""The picture of the motor bench."""

from matplotlib.figure import Figure

from diagnosis.benches.motor import MotorBench
from diagnosis.benches.plotting import BLACK, BLUE, png


def motor_picture(bench: MotorBench) -> bytes:
    """PNG of the steady states."""
    figure = Figure(figsize=(11, 5), layout="constrained")
    axes = figure.subplots(1, 2)
    steady = bench.steady
    axes[0].plot(steady.voltage_V, steady.measured_speed_rad_s, "o", color=BLACK, label="measured (Table 1)")
    axes[0].plot(steady.curve.voltage_V, steady.curve.speed_rad_s, color=BLUE, label=steady.robot.name)
    axes[0].set(xlabel="voltage [V]", ylabel="speed [rad/s]")
    axes[1].plot(steady.voltage_V, steady.measured_current_A, "o", color=BLACK, label="measured (Table 1)")
    axes[1].plot(steady.curve.voltage_V, steady.curve.current_A, color=BLUE, label=steady.robot.name)
    axes[1].set(xlabel="voltage [V]", ylabel="current [A]")
    axes[0].legend()
    return png(figure)
