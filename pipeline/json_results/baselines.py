"""The result of `symolo baselines --json`."""

from dataclasses import asdict
from typing import TYPE_CHECKING

from pipeline.json_results.base import JsonPart, JsonResult
from symolo.evaluation.errors import Errors

if TYPE_CHECKING:  # the methods need packages that the schema of the results does not
    from pipeline.baselines.compare import BaselineComparison


class ErrorsPart(JsonPart):
    """Errors of one method in one run."""

    run: str
    """Name of the run, such as CW/test_1."""
    method: str
    """Name of the method."""
    ate_m: float
    """Absolute trajectory error [m], the root mean square."""
    ate_rad: float
    """Absolute error of the heading [rad], the root mean square."""
    median_m: float
    """Median distance [m] from the true place."""
    worst_m: float
    """Largest distance [m] from the true place."""
    end_m: float
    """Distance [m] from the true place at the last pose."""
    rpe_per_s_m: float | None
    """Relative pose error [m] over one second; null where no two poses are so far apart."""
    rpe_per_s_rad: float | None
    """Relative error of the heading [rad] over one second; null as above."""
    rpe_per_m_m: float | None
    """Relative pose error [m] over one metre of the true path; null where no two poses are so far apart."""
    rpe_per_m_rad: float | None
    """Relative error of the heading [rad] over one metre; null as above."""
    nees: float | None
    """Normalised estimation error squared, divided by its degrees of freedom; null without a covariance."""
    within: float | None
    """Share of the poses whose truth lies in the method's own 95 % region; null without a covariance."""
    poses: int
    """Number of estimated poses."""
    coverage: float
    """Share of the seconds of the run in which there is an estimate."""

    @classmethod
    def from_errors(cls, run: str, method: str, errors: Errors) -> "ErrorsPart":
        return cls(run=run, method=method, **asdict(errors))


class BaselinesResult(JsonResult):
    """The errors of localisation by each method in each run, as in baselines.json."""

    command: str = "baselines"
    """Name of the command."""
    folder: str
    """The output folder, as it was named."""
    methods: dict[str, str]
    """What each method does, by its name."""
    left_out: dict[str, str]
    """Reason for each method that the data do not allow, by its name."""
    errors: list[ErrorsPart]
    """The errors of each method in each run."""
    warnings: list[str]
    """Why errors may be smaller here than elsewhere, and what is suspicious about own estimates."""

    @classmethod
    def from_comparison(cls, folder: str, compared: "BaselineComparison") -> "BaselinesResult":
        errors = [
            ErrorsPart.from_errors(run.name, method.name, compared.results[run.name, method.name].errors)
            for run in compared.runs
            for method in compared.methods
        ]
        return cls(
            folder=folder,
            methods={method.name: method.what for method in compared.methods},
            left_out=dict(compared.left_out),
            errors=errors,
            warnings=list(compared.warnings),
        )
