"""Command that trains a network on a release: train."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Runs, Seed, checked_input, names, new_file_check
from symolo.core.errors import InputError, nearest


def train(
    folder: Annotated[Path, typer.Argument(metavar="DIR", callback=checked_input, help="A release with images.")],
    *,
    out: Annotated[
        Path,
        typer.Option(
            "--out", metavar="MODEL", callback=new_file_check(".npz"), help="File for the model, .npz; it is replaced."
        ),
    ],
    inputs: Annotated[
        str, typer.Option("--inputs", metavar="NAMES", help="What the network reads: images, ranges, or both.")
    ] = "images,ranges",
    runs: Runs = None,
    epochs: Annotated[
        int,
        typer.Option(
            min=1,
            max=10_000,
            metavar="N",
            help="Maximum number of passes through the images. Training ends earlier if the runs that are set aside "
            "show no more progress.",
        ),
    ] = 80,
    seed: Seed = 1,
) -> None:
    """Train a network that locates the robot from an image and the ranges, for the method `learned` of `baselines`.

    The network learns the arena: it gives a probability for each position and heading near the training poses. A fifth
    of the runs, at least one, are set aside; they decide when training stops, and how far the network is trusted. The
    model file contains numbers only. The same release, options and seed give the same file on the same kind of machine
    with the same version of PyTorch. PyTorch comes with the extra `learn`.

    Example: symolo train data --out model.npz

    Example: symolo baselines other-data --methods odometry,learned --model model.npz --start-sd-cm 5 --start-sd-deg 5
    --out located
    """
    from pipeline.baselines.learned.model import INPUTS, Input
    from pipeline.baselines.learned.training_runs import check_trainable, trained
    from pipeline.baselines.runs import chosen, open_runs
    from symolo.core.files.atomic_files import write_file
    from symolo.core.progress import plural, report_here

    wanted = names(inputs, "--inputs")
    for name in set(wanted) - set(INPUTS):
        raise InputError("--inputs", got=name, allowed=", ".join(INPUTS), nearest=nearest(name, INPUTS))
    training_runs = chosen(open_runs(folder), runs)
    check_trainable(training_runs)
    chosen_inputs: tuple[Input, ...] = tuple(name for name in INPUTS if name in wanted)
    result = trained(training_runs, chosen_inputs, max_epochs=epochs, seed=seed, report=report_here())
    write_file(out, result.model.file_bytes())
    about = result.model.about
    typer.echo(
        f"trained on {plural(result.training_images, 'image')} of {plural(len(about.training_runs), 'run')}, "
        f"for {plural(about.epochs, 'epoch')}"
    )
    typer.echo(
        f"in {plural(result.validation_images, 'image')} of {plural(len(about.validation_runs), 'run')} set aside, the "
        f"most likely place is {1e3 * result.network.median_m:.0f} mm off (median)"
    )
    typer.echo(f"{len(result.model.likelihood.cells)} cells of {100 * about.cell_m:g} cm\n{out}")
