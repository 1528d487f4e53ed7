"""Comparison of methods: the estimates and errors of each one in each run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from pipeline.baselines import METHODS
from pipeline.baselines.base import NO_IMAGES, Estimator, Method
from pipeline.baselines.own_estimates import Judgement
from pipeline.baselines.robot_knowledge import SLIP_M_SQRT_M
from pipeline.baselines.runs import LoggedRun, TrueRun
from symolo.core.arrays import Array
from symolo.core.errors import InputError, nearest
from symolo.core.progress import Report
from symolo.core.random_streams import stream
from symolo.evaluation.errors import Errors, errors_of
from symolo.evaluation.estimate import Estimate


@dataclass(frozen=True)
class MethodResult:
    """Estimates and errors of one method in one run."""

    estimate: Estimate
    errors: Errors


@dataclass(frozen=True)
class BaselineComparison:
    """Estimates of all methods in all runs, with their errors and the conditions under which they were made."""

    methods: tuple[Estimator, ...]
    runs: tuple[TrueRun, ...]
    results: Mapping[tuple[str, str], MethodResult]
    """Results by name of run and method."""
    left_out: Mapping[str, str]
    """Reason by name for each method that cannot be used on these runs."""
    start_sd: Array
    """(3,), x [m], y [m], yaw [rad]: standard deviation of the error of the start."""
    slip_m_sqrt_m: float
    """Standard deviation [m] that methods assume for the random error of a wheel's distance after 1 m."""
    seed: int
    warnings: tuple[str, ...] = ()
    """Why errors may be smaller here than elsewhere, and what is suspicious about own estimates."""
    conditions: str = ""
    """How own estimates were compared; empty without any."""

    def with_judgement(self, judgement: Judgement) -> "BaselineComparison":
        """Return the comparison with own estimates, too."""
        own_results = {key: MethodResult(one.estimate, one.errors) for key, one in judgement.evaluations.items()}
        return replace(
            self,
            methods=(*self.methods, *judgement.methods),
            results={**self.results, **own_results},
            warnings=(*self.warnings, *judgement.warnings),
            conditions=judgement.conditions,
        )


def methods_of(names: Sequence[str], where: str) -> tuple[Method, ...]:
    """Return these methods, each once, in the order of the table.

    Raises:
        InputError: There is no method of a name.
    """
    known = {method.name: method for method in METHODS}
    for name in names:
        if name not in known:
            raise InputError(where, got=name, allowed=", ".join(known), nearest=nearest(name, known))
    return tuple(method for method in METHODS if method.name in names)


def why_not(method: Method, runs: Sequence[LoggedRun]) -> str:
    """Return why a method cannot be used on a release with these runs; empty where it can."""
    for run in runs:
        if why := method.lacks(run.further):
            return why
    if not method.learns:
        return ""
    if any(run.images is None for run in runs):
        return NO_IMAGES
    return "there is one run only: it learns from the others" if len(runs) == 1 else ""


def compare(
    methods: Sequence[Method],
    runs: Sequence[LoggedRun],
    all_runs: Sequence[LoggedRun],
    *,
    start_sd: Array,
    slip_m_sqrt_m: float = SLIP_M_SQRT_M,
    seed: int,
    report: Report,
) -> BaselineComparison:
    """Localise in `runs`; methods learn from all other runs of `all_runs`."""
    left_out = {method.name: why for method in methods if (why := why_not(method, all_runs))}
    usable = tuple(method for method in methods if method.name not in left_out)
    training_runs = {run.name: training_run for run in all_runs if (training_run := run.training_run())}
    results = {}
    with report.stage("baselines", len(runs) * len(usable), "estimates") as stage:
        for run in runs:
            knowledge = run.knowledge(start_sd, stream(seed, run.name, "start"), slip_m_sqrt_m)
            others = [training_run for name, training_run in training_runs.items() if name != run.name]
            for method in usable:
                rng = stream(seed, run.name, method.name)
                estimate = method.estimate(knowledge, others if method.learns else (), rng)
                errors = errors_of(estimate, knowledge.t_s, run.truth)
                results[run.name, method.name] = MethodResult(estimate, errors)
                stage.update("all", len(results))
    true_runs = tuple(run.true_run for run in runs)
    return BaselineComparison(usable, true_runs, results, left_out, start_sd, slip_m_sqrt_m, seed)
