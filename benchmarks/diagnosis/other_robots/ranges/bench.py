"""One range sensor before targets at known distances: rows, circumstances, materials and stated noise."""

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array, log_uniform, pick, significant
from benchmarks.diagnosis.other_robots.range_noise import polynomial_mm, stated_noise

REFLECTANCES = {
    "white_paper": 0.85,
    "white_wall": 0.9,
    "cardboard": 0.5,
    "grey_card": 0.18,
    "black_card": 0.05,
    "wood": 0.45,
    "plastic": 0.6,
    "black_foam": 0.08,
    "brick": 0.35,
    "curtain": 0.25,
    "brushed_steel": 0.7,
    "carpet": 0.12,
}


class RangeBench:
    """The rows of one bench: where the targets were, and the circumstances."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.reach = log_uniform(rng, 0.4, 4.0)
        self.n = round(log_uniform(rng, 20, 400))
        distances = self._distances(rng)
        self.order = pick(rng, ["random", "sorted", "up_and_down", "sweeps"], [0.55, 0.2, 0.15, 0.1])
        self.d = np.round(self._ordered(rng, distances), 3)
        self.material, self.reflectance = self._materials(rng)
        self.rho = np.array([self.reflectance[m] for m in self.material])
        self.angle = self._angles(rng)
        climate = rng.random()
        self.reference = float(pick(rng, [20, 22, 23, 25]))
        self.temperature = np.round(self._temperatures(rng, climate), 1)
        if rng.random() < 0.4:
            self.lux = np.full(self.n, round(log_uniform(rng, 50, 1000)))
        else:
            self.lux = np.round(np.exp(rng.uniform(np.log(30), np.log(12000), self.n)))
        self.t = np.round(np.arange(self.n) * significant(log_uniform(rng, 0.2, 5), 2), 1)
        self.last = float(self.t[-1])
        top = self.reach * 1000 * log_uniform(rng, 0.004, 0.025)
        self.origin = significant(rng.uniform(0, 0.3) * min(1, self.reach), 2)
        parts = rng.dirichlet([1, 1, 1])
        first = min(log_uniform(rng, 0.5, 4), 0.7 * top)
        self.polynomial = polynomial_mm(first, top, self.reach - self.origin, parts)
        self.noise = stated_noise(self.polynomial, self.origin, self.d)
        self.tolerance = (
            significant(log_uniform(rng, 0.0002, 0.005), 2),
            significant(log_uniform(rng, 0.0005, 0.02), 2),
        )

    def _distances(self, rng: np.random.Generator) -> Array:
        """Return distances at stops or at random."""
        nearest = float(rng.uniform(0.02, 0.12)) * min(1.0, self.reach)
        farthest = self.reach * float(rng.uniform(0.75, 1.0))
        if rng.random() < 0.5:
            stops = np.linspace(nearest, farthest, int(rng.integers(8, 45)))
            return np.concatenate([stops] * (self.n // len(stops) + 1))[: self.n]
        return rng.uniform(nearest, farthest, self.n)

    def _ordered(self, rng: np.random.Generator, d: Array) -> Array:
        """Return the distances in the order of the rows."""
        if self.order == "random":
            return rng.permutation(d)
        if self.order == "sorted":
            return np.sort(d)
        if self.order == "up_and_down":
            d = np.sort(d)
            return np.concatenate([d[::2], d[1::2][::-1]])
        parts = np.array_split(rng.permutation(d), max(2, self.n // 40))
        return np.concatenate([np.sort(part) for part in parts])

    def _materials(self, rng: np.random.Generator) -> tuple[Array, dict[str, float]]:
        """Return the material of each row and the reflectances."""
        count = 1 if self.n < 40 or rng.random() < 0.35 else int(rng.integers(2, 6))
        names = [str(name) for name in rng.choice(list(REFLECTANCES), size=count, replace=False)]
        reflectance = {name: significant(REFLECTANCES[name] * rng.uniform(0.85, 1.1), 2) for name in names}
        if count > 1 and rng.random() < 0.25:  # one material after the other
            return np.array([names[int(k * count / self.n)] for k in range(self.n)]), reflectance
        return rng.choice(names, size=self.n), reflectance

    def _angles(self, rng: np.random.Generator) -> Array:
        """Return the angles of incidence: none, some, or any."""
        spread = rng.random()
        if spread < 0.4:
            return np.zeros(self.n)
        if spread < 0.75:
            return rng.choice([0, 0.2618, 0.5236, 0.7854], size=self.n)
        return np.round(rng.uniform(0, rng.uniform(0.3, 1.0), self.n), 4)

    def _temperatures(self, rng: np.random.Generator, climate: float) -> Array:
        """Return temperatures that are constant, chosen at random, or rising."""
        if climate < 0.4:
            return self.reference + rng.normal(0, 0.3, self.n)
        if climate < 0.75:
            return rng.choice([10, 15, 20, 25, 32, 40], size=self.n) + rng.normal(0, 0.3, self.n)
        rise = np.linspace(0, rng.uniform(5, 25), self.n)
        return self.reference - 5 + rise + rng.normal(0, 0.3, self.n)
