import numpy as np
import pytest

from diagnosis.inference.unexplained.bases import RUNS_OF_OUTLIERS, RUNS_OF_ROWS, bases, standing_out
from diagnosis.predictors.base import Covariate, CovariateShape

STEPS = (3.0, -5.0, 2.0, -4.0, 6.0, -2.0)


def explained(covariate, values):
    """Greatest share of the squares that one basis takes."""
    rows = np.ones(len(values), dtype=bool)
    shares = []
    for basis in bases(covariate, rows):
        left = values - basis.columns @ np.linalg.lstsq(basis.columns, values, rcond=None)[0]
        shares.append(1.0 - float(left @ left) / float(values @ values))
    return max(shares)


def test_ringing_after_steps_either_way_is_found_by_the_time_since_and_the_size_of_the_step():
    """An oscillation of 20 Hz that decays in 60 ms, as large as the step and of its sign."""
    since_s = np.tile(0.002 * np.arange(1, 301), len(STEPS))
    size = np.repeat(STEPS, 300)
    ringing = size * np.exp(-since_s / 0.06) * np.sin(2.0 * np.pi * 20.0 * since_s)
    assert explained(Covariate("time_since_step_s", since_s, CovariateShape.SINCE, size=size), ringing) > 0.7
    assert explained(Covariate("time_since_step_s", since_s), ringing) < 0.2


@pytest.mark.parametrize("length", [0.1, 0.055])
def test_a_wave_along_few_rows(length):
    x = np.random.default_rng(1).permutation(np.linspace(0.04, 1.0, 40))
    assert explained(Covariate("distance_m", x), np.sin(2.0 * np.pi * x / length)) > 0.7


def test_finer_waves_are_found_where_a_covariate_may_have_them():
    """A range sensor with an error every 5 cm, in a room of 4 m."""
    x = np.random.default_rng(1).permutation(np.linspace(0.1, 4.1, 800))
    wave = np.sin(2.0 * np.pi * x / 0.05)
    assert explained(Covariate("distance_m", x, max_waves=100.0), wave) > 0.7
    assert explained(Covariate("distance_m", x), wave) < 0.1


def test_a_floor_that_brakes_in_one_place_brakes_either_way():
    """Along a line there and back, over a rough part of half a metre."""
    x = np.concatenate([np.linspace(0.0, 3.0, 300), np.linspace(3.0, 0.0, 300)])
    way = np.repeat([1.0, -1.0], 300)
    braked = -way * (np.abs(x - 1.0) < 0.25)
    assert explained(Covariate("position", x, second=0.1 * x, size=way), braked) > 0.3
    assert explained(Covariate("position", x, second=0.1 * x), braked) < 1e-9


def test_a_load_that_grows_with_the_size_of_a_turn_brakes_either_way():
    """A curve of two wheels: each turn comes with both directions of the wheel."""
    turn = np.tile(np.linspace(-3.0, 3.0, 150), 4)
    way = np.repeat([1.0, -1.0], 300)
    braked = -way * np.abs(turn)
    assert explained(Covariate("turn_rad_s", turn, size=way), braked) > 0.99
    assert explained(Covariate("turn_rad_s", turn), braked) < 0.1


@pytest.mark.parametrize("teeth", [1, 3, 5, 11])
def test_a_gear_with_so_many_faults_in_a_turn_changes_the_speed_by_a_share(teeth):
    speed = np.abs(np.sin(np.linspace(0.0, 9.0, 1500))) * 10.0
    angle = np.cumsum(speed) * 0.005
    ripple = 0.03 * speed * np.sin(teeth * angle + 0.4)
    assert explained(Covariate("angle_rad", angle, CovariateShape.PERIODIC, size=speed), ripple) > 0.99


def test_harmonics_that_rows_cannot_show_are_not_looked_for():
    """At 0.5 rad a row the fifth is seen 2.5 times a cycle; from then on they are told from slower ones no more."""
    angle = 0.5 * np.arange(200.0)
    rows = np.ones(200, dtype=bool)
    names = [basis.what for basis in bases(Covariate("angle_rad", angle, CovariateShape.PERIODIC), rows)]
    assert names == ["turn", "harmonic 4 of a turn"]


def test_events_of_one_size_and_more_shift_the_residual_either_way():
    """Of 40 events, the 20 large ones kick to their side; the levels count those of either size, and the large ones."""
    side = np.tile([0.0, 1.0, 0.0, -1.0], 20)
    large = np.arange(80) % 8 < 4
    levels = np.stack([side, side * large], axis=1)
    event = Covariate("turn_reversal_rad_s", side * np.where(large, 0.5, 0.1), CovariateShape.EVENT, levels=levels)
    assert explained(event, side * large) > 0.999
    assert {basis.tries for basis in bases(event, np.ones(80, dtype=bool))} == {2}


def test_a_wall_that_is_turned_is_a_line_along_it_that_ends_at_its_corners():
    """Beams at up to 60 degrees grow by the shift of the wall over the cosine."""
    rng = np.random.default_rng(4)
    place, slanted = rng.uniform(0.0, 6.0, 400), 1.0 / np.cos(rng.uniform(-1.0, 1.0, 400))
    turned = np.where((place >= 2.0) & (place < 3.0), (place - 2.5) * slanted, 0.0)
    outline = Covariate("wall_place_m", place, CovariateShape.OUTLINE, size=slanted, corners=(0.0, 2.0, 3.0, 5.0, 6.0))
    assert explained(outline, turned) > 0.999
    assert explained(Covariate("wall_place_m", place), turned) < 0.9


class TestRunsOfRows:
    TRIAL = np.repeat([0, 1, 2, 3], 250)
    TAME = np.zeros(1000, dtype=bool)

    def max_taken(self, left):
        """Greatest fall of the squares less what so many tries bring by chance, 2 ln(tries)."""
        falls = [
            float(basis.columns[:, 0] @ left) ** 2 / float(basis.columns[:, 0] @ basis.columns[:, 0])
            - 2.0 * np.log(float(basis.tries))
            for basis in standing_out(left, self.TRIAL, self.TAME, RUNS_OF_ROWS)
        ]
        return max(falls)

    def test_a_few_bursts_stand_out(self):
        left = np.random.default_rng(1).standard_normal(1000)
        for begin in (40, 333, 610, 900):
            left[begin : begin + 8] -= 2.5
        assert self.max_taken(left) > 40.0

    def test_single_rows_do_not(self):
        for seed in range(20):
            rng = np.random.default_rng(seed)
            left = rng.standard_normal(1000)
            left[rng.choice(1000, 20, replace=False)] = 3.0
            assert self.max_taken(left) < 10.0

    def test_wild_rows_that_a_logger_may_cause_make_no_long_run(self):
        left = np.zeros(1000)
        wild = np.isin(np.arange(1000), [300, 301, 302, 303, 304, 308, 309, 310])
        left[wild] = 3.0
        assert not next(standing_out(left, self.TRIAL, self.TAME, RUNS_OF_ROWS)).is_of_outliers
        assert not list(standing_out(left, self.TRIAL, wild, RUNS_OF_ROWS))
        assert next(standing_out(left, self.TRIAL, wild, RUNS_OF_OUTLIERS)).is_of_outliers

    def test_a_run_lies_in_one_trial(self):
        left = np.zeros(1000)
        left[246:254] = 1.0
        column = next(standing_out(left, self.TRIAL, self.TAME, RUNS_OF_ROWS)).columns[:, 0]
        assert set(np.flatnonzero(column)) in ({246, 247, 248, 249}, {250, 251, 252, 253})

    def test_few_rows_have_none(self):
        assert not list(standing_out(np.ones(40), np.zeros(40, dtype=int), np.zeros(40, dtype=bool), RUNS_OF_ROWS))
