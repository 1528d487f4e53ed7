"""What a run loses if another look renders it: the response of its camera, which belongs to the look."""

import shlex
from collections.abc import Iterator, Sequence

from configs.references import shipped_names
from configs.schema.appearance.camera_look import CameraLook
from configs.schema.scenario import SceneSpec

_GREY = "monochrome"


def response_warnings(before: Sequence[SceneSpec], after: Sequence[SceneSpec]) -> tuple[str, ...]:
    """Return a sentence for each special camera of the source that a look replaces by another one.

    Special are cameras with a name of their own, monochrome ones, and those with a manual exposure.

    Args:
        before: Runs of the source.
        after: Runs under the looks, in the order of `before` for each draw.
    """
    texts = {}
    for k, spec in enumerate(after):
        source = before[k % len(before)]
        old, new = source.look.camera, spec.look.camera
        words = ", ".join(_words(old))
        if source.is_imported or not words or _kind(old) == _kind(new):
            continue
        options = shlex.join([word for text in _settings(old, new) for word in ("--set", text)])
        text = f"the camera of the run ({words}) gives way to that of the look {spec.look.name}"
        texts[f"{text}; {options} keeps it" if options else text] = None
    return tuple(texts)


def _kind(camera: CameraLook) -> tuple[object, ...]:
    return camera.name, camera.colour_filter == _GREY, camera.manual_exposure


def _words(camera: CameraLook) -> Iterator[str]:
    if camera.name is not None:
        yield camera.name
    if camera.colour_filter == _GREY:
        yield camera.colour_filter
    if camera.manual_exposure is not None:
        yield "manual exposure"


def _settings(old: CameraLook, new: CameraLook) -> Iterator[str]:
    """Yield settings that bring the old camera back, as far as options can name it."""
    if old.name is not None and old.name not in shipped_names("camera"):
        return
    if old.name != new.name and old.name is not None:
        yield f"look.camera={old.name}"
    elif _GREY in {old.colour_filter, new.colour_filter} and old.colour_filter != new.colour_filter:
        yield f"look.camera.colour_filter={old.colour_filter}"
    if (manual := old.manual_exposure) is not None and manual != new.manual_exposure:
        yield f"look.camera.exposure_time_s={old.exposure_time_s:g}"
        yield f"look.camera.manual_exposure={{iso: {manual.iso:g}, f_number: {manual.f_number:g}}}"
