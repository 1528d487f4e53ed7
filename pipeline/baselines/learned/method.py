"""Particle filter whose particles are weighted by the heat maps of a trained network."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pipeline.baselines.base import NO_IMAGES, Method, TrainingRun
from pipeline.baselines.learned.heat_map import PoseLikelihood
from pipeline.baselines.learned.model import LocalisationModel, run_fingerprint
from pipeline.baselines.learned.readings import NetworkReadings, check_shape, knowledge_of
from pipeline.baselines.learned.torch_side.network import heat_maps, pytorch
from pipeline.baselines.motion import rolled_distances_m
from pipeline.baselines.particles import ParticleCloud
from pipeline.baselines.robot_knowledge import RobotKnowledge
from pipeline.baselines.runs import LoggedRun
from symolo.arena.fingerprint import arena_fingerprint
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.progress import plural
from symolo.evaluation.estimate import Estimate

PARTICLES = 1000
NO_MODEL = "there is no model: train one with `symolo train`, and name it with --model"


def filtered(knowledge: RobotKnowledge, likelihood: PoseLikelihood, heat: Array, rng: np.random.Generator) -> Estimate:
    """Return the poses of a run, at all rows, by its wheels and the heat maps (M, C) of its images."""
    assert knowledge.images is not None  # noqa: S101 - there are heat maps
    cloud = ParticleCloud(knowledge, rng, PARTICLES)
    heat_of_row = dict(zip(knowledge.images.rows.tolist(), heat, strict=True))
    last_s = -np.inf
    estimates = []
    for row, rolled_m in enumerate(rolled_distances_m(knowledge)):
        cloud.predict(rolled_m)
        if row in heat_of_row:
            now_s = float(knowledge.t_s[row])
            cloud.weigh(likelihood.log_ratio(heat_of_row[row], cloud.particles[:, :3]), now_s - last_s)
            last_s = now_s
        estimates.append(cloud.estimate())
    poses, covariances = zip(*estimates, strict=True)
    return Estimate(np.arange(len(knowledge)), np.array(poses), np.array(covariances))


def with_model(methods: Sequence[Method], model: LocalisationModel, runs: Sequence[LoggedRun]) -> tuple[Method, ...]:
    """Return the methods, of which `learned` has the model.

    Raises:
        InputError: `learned` is not among them, or a run has another arena, no images, or images of another shape.
        EnvironmentLacking: PyTorch is not installed.
    """
    if METHOD.name not in [method.name for method in methods]:
        raise InputError(f"--model is of the method {METHOD.name}, which is not in --methods")
    for run in runs:
        if run.images is None:
            raise InputError(f"--model: {NO_IMAGES}", where=run.name)
        check_shape(run.images.pixels(0).shape, run.name)
        if arena_fingerprint(knowledge_of(run).map) != model.about.arena:
            cure = "train a model on a release with this arena"
            raise InputError("--model: it was trained in another arena", where=run.name, cure=cure)
    pytorch()
    return tuple(_method_with(model) if method.name == METHOD.name else method for method in methods)


def overlap(model: LocalisationModel, runs: Sequence[LoggedRun]) -> str:
    """Return a warning if some of these runs trained a model, or were set aside for it; empty if none was."""
    about = model.about
    used = {*about.training_runs, *about.validation_runs}
    count = sum(run_fingerprint(run.spec) in used for run in runs)
    if not count:
        return ""
    trained = f"{count} of these {plural(len(runs), 'run')} trained the model, counting those that were set aside"
    return f"{trained}: there, the errors of {METHOD.name} are likely to be smaller than in other runs"


def _method_with(model: LocalisationModel) -> Method:
    def estimate(
        knowledge: RobotKnowledge, _training_runs: Sequence[TrainingRun], rng: np.random.Generator
    ) -> Estimate:
        readings = NetworkReadings.from_knowledge(knowledge)
        return filtered(knowledge, model.likelihood, heat_maps(model, readings), rng)

    what = f"odometry; particles are weighted by a trained network on {' and '.join(model.about.inputs)}"
    return replace(METHOD, what=what, estimate=estimate, lacks=lambda _: "")


def _no_model(_knowledge: RobotKnowledge, _training_runs: Sequence[TrainingRun], _rng: np.random.Generator) -> Estimate:
    raise InputError(NO_MODEL)


METHOD = Method(
    "learned",
    "learned heat maps",
    "odometry; particles are weighted by a trained network",
    _no_model,
    lacks=lambda _: NO_MODEL,
)
