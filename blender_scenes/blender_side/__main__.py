"""The Blender process: reads a request, renders its frames, puts each in place and reports it."""

import hashlib
import os
import signal
import sys
import time
from dataclasses import replace
from pathlib import Path

import cv2

from blender_scenes.annotations.job import AnnotationJob
from blender_scenes.blender_side.loading import load_bpy
from blender_scenes.render.frame_files import FrameFile, put_in_place
from blender_scenes.render.job import RenderJob
from blender_scenes.render.job_file import read_job
from blender_scenes.render.protocol import FrameBegun, FrameDone, ProbeStep, Ready, RenderRequest
from blender_scenes.render.surroundings import SYSTEM_PACKAGES
from sensors.camera.lens_warp import field_of_view
from sensors.camera.response import develop, encode_jpeg
from symolo.core.child_process import SCRATCH, Failed, Finished, Owner
from symolo.core.errors import EnvironmentLacking
from symolo.core.os_errors import lacking
from symolo.dataset.layout import frame_name


def main() -> int:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the renderer decides what follows
    owner = Owner()
    request = RenderRequest.model_validate_json(owner.next_request())
    cv2.setNumThreads(request.threads)
    try:
        load_bpy(request.threads)
        _WORK[request.work](request, owner, Path(os.environ[SCRATCH]))
    except Exception as error:
        cause = _lacking_here(error)
        owner.send(Failed(error="environment" if cause else "engine", text=cause or str(error)))
        if cause:
            return 1
        raise
    owner.send(Finished())
    return 0


def _lacking_here(error: Exception) -> str:
    """Return what the machine lacks and the cure in one line; empty where the error is not the machine's."""
    cause = lacking(error)
    if not cause and isinstance(error, ImportError):
        return f"{error}; run `apt-get install -y {SYSTEM_PACKAGES}`"
    return str(error) if isinstance(error, EnvironmentLacking) else cause


def _render(request: RenderRequest, owner: Owner, scratch: Path) -> None:
    from blender_scenes.blender_side import build, choice, engine  # noqa: PLC0415 - they import bpy

    begin = time.perf_counter()
    text = read_job(Path(request.job_path))
    job = RenderJob.from_json(text.decode())
    views = {view.number: view for view in job.frames}
    build.start()
    user_files = Path(request.user_files) if request.user_files else None
    build.build(job.scene, job.camera, user_files, caustics=job.sampling.paths.caustics)
    engine.configure(job, request.threads, scratch)
    job_sha256, field = hashlib.sha256(text).hexdigest(), field_of_view(job.camera)
    images = Path(request.folder)
    tracer = choice.tracer_for(job, job_sha256, images, request.threads, scratch, lambda: owner.send(ProbeStep()))
    owner.send(Ready(seconds=time.perf_counter() - begin))
    for number in request.numbers:
        begin = time.perf_counter()
        owner.send(FrameBegun(number=number))
        pixels = develop(tracer.light(views[number]), job.response, tracer.metered, number, field)
        data = encode_jpeg(pixels, job.response.jpeg_quality)
        path = images / frame_name(number)
        sha256 = put_in_place(data, path, job.camera.width_px, job.camera.height_px)
        taken_s = time.perf_counter() - begin
        owner.send(FrameDone(frame=FrameFile(number, path.name, sha256, len(data), taken_s, request.threads)))


def _annotate(request: RenderRequest, owner: Owner, scratch: Path) -> None:
    from blender_scenes.blender_side import annotate  # noqa: PLC0415 - it imports bpy

    begin = time.perf_counter()
    job = AnnotationJob.from_json(read_job(Path(request.job_path)).decode())
    views = {view.number: view for view in job.frames}
    annotate.start(job, request.threads, scratch)
    owner.send(Ready(seconds=time.perf_counter() - begin))
    for number in request.numbers:
        owner.send(FrameBegun(number=number))
        for file in annotate.annotate(job, views[number], Path(request.folder)):
            owner.send(FrameDone(frame=replace(file, threads=request.threads)))


_WORK = {"images": _render, "annotations": _annotate}


if __name__ == "__main__":
    sys.exit(main())
