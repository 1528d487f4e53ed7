"""A random agent and one that follows the line, in the Gymnasium environment.

python examples/gym_agents.py --scenario smoke --steps 200
"""

import argparse

import gymnasium
import numpy as np

THRESHOLD = 0.45
SPEED_M_S, GAIN_RAD_S = 0.18, 0.9


class RandomAgent:
    def __init__(self, space: gymnasium.Space) -> None:
        self._space = space

    def act(self, _readings: dict[str, np.ndarray]) -> np.ndarray:
        return self._space.sample()


class LineAgent:
    def __init__(self) -> None:
        self._offset = 0.0

    def act(self, readings: dict[str, np.ndarray]) -> np.ndarray:
        (dark,) = np.nonzero(readings["line"] < THRESHOLD)
        if len(dark):
            self._offset = float(dark.mean()) - 3.5
        return np.array([SPEED_M_S * (1.0 - abs(self._offset) / 7.0), GAIN_RAD_S * self._offset], dtype=np.float32)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", default="smoke")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    with gymnasium.make("pipeline.gym:symolo/Drive-v0", scenario=arguments.scenario) as environment:
        environment.action_space.seed(arguments.seed)
        for agent in (RandomAgent(environment.action_space), LineAgent()):
            readings, info = environment.reset(seed=arguments.seed)
            total, progress_m = 0.0, 0.0
            steps = 0
            while steps < arguments.steps:
                steps += 1
                readings, reward, terminated, truncated, info = environment.step(agent.act(readings))
                total, progress_m = total + reward, progress_m + info["progress_m"]
                if terminated or truncated:
                    break
            end = f"touched {', '.join(info['touched'])}" if info["touched"] else "no contact"
            print(f"{type(agent).__name__}: {steps} steps, {progress_m:.2f} m of track, reward {total:.2f}, {end}")


if __name__ == "__main__":
    main()
