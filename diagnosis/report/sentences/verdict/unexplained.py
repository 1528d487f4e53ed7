"""What stays unexplained in the residuals, in sentences."""

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.naming.verdict import DOUBT
from diagnosis.inference.unexplained.adequacy import CLUSTER, LEVEL, Structure
from diagnosis.inference.unexplained.bases import RUNS_OF_OUTLIERS, RUNS_OF_ROWS
from diagnosis.inference.unexplained.forms import GAIN
from diagnosis.inference.unexplained.scatter import SCATTER
from diagnosis.inference.unexplained.uneven_noise import UNEVEN
from diagnosis.predictors.pose.lost_counts import LOST
from diagnosis.predictors.pose.wheel_slip import PATCH, SLIP
from diagnosis.predictors.wheels.floor_loads import FRICTION
from diagnosis.predictors.wheels.turning_loads import TURNING
from diagnosis.report.sentences.quantities import along, listed, quantity_words


def unexplained_sentence(structure: Structure) -> str:
    """Return what remains unexplained and where, in one sentence."""
    chance = "less than 1e-12" if structure.p < 1e-12 else f"{structure.p:.2g}"
    if structure.what.startswith(SCATTER):
        return (
            f"The residuals of {structure.observed} have a {structure.what}, and no covariate explains it. The "
            f"probability of this by chance is {chance}, if the noise is stated correctly."
        )
    if structure.what.startswith(UNEVEN):
        return (
            f"The residuals of {structure.observed} have {uneven_noise_words(structure)}; the probability of this by "
            f"chance is {chance}."
        )
    words, _ = quantity_words(structure.covariate)
    shape, _, sign = structure.what.partition(", ")
    shape = {
        CLUSTER: f"outliers at neighbouring values of {words}",
        RUNS_OF_ROWS: "successive rows that are off together",
        RUNS_OF_OUTLIERS: "outliers in successive rows",
        "trend": f"a smooth curve over {words}",
        "category": f"another mean for each {words}",
        "turn": f"an oscillation with {words}",
        "place": "an error that depends on the place",
        "outline": f"an error that depends on the {words}",
        "event": f"a shift at each {words}",
        "functions": f"an error at a small {words}",
        PATCH: "motion that wheels lose or gain on a patch of the floor",
        SLIP: "motion that wheels lose or gain while they accelerate or brake",
        LOST: "counts that an encoder loses or adds at one angle of its wheel",
        "step": f"a step at one value of {words}",
        "kink": f"a straight line that begins at one value of {words}",
        GAIN: f"a gain that changes with {words}",
        "bump": f"a bump around one value of {words}",
    }.get(shape, f"a {shape} over {words}") + (f", {sign}" if sign else "")
    if structure.what.startswith(FRICTION):
        shape = structure.what
    where = along(structure.covariate)
    if structure.covariate == TURNING:
        where, shape = f"{where}, the rate of turning", f"as from a {structure.what}"
    return (
        f"The residuals of {listed(structure.quantities)} have structure along {where} ({shape}). Its root mean square "
        f"is {structure.size:.2g} standard deviations of the noise, and the probability of it by chance is {chance}."
    )


def nothing_left(diagnosis: Diagnosis, *, numbers_are_off: bool = False) -> str:
    """Return that no structure in the residuals is certain, and which one is most likely, in one or two sentences."""
    nothing = "Beside these numbers, nothing" if numbers_are_off else "Nothing"
    first = next(iter(diagnosis.adequacy.structures), None)
    if first is None or first.p >= DOUBT:
        smallest = f" (smallest p-value of all tests: {first.p:.2g})" if first else ""
        return f"{nothing}: no covariate shows more structure in the residuals than is expected by chance{smallest}."
    return (
        f"{nothing} is certain. The residuals of {listed(first.quantities)} may depend on {along(first.covariate)} "
        f"(p = {first.p:.2g}), but structure counts as such only if p is below {LEVEL:g}."
    )


def uneven_noise_words(structure: Structure) -> str:
    """Return where the noise is larger, with the covariate in words."""
    return structure.what.replace(structure.covariate, quantity_words(structure.covariate)[0])
