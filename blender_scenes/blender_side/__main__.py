"""The Blender process: reads a request, renders its frames, puts each in place, and says so."""

import os
import shutil
import signal
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path
from typing import TextIO

import cv2

from blender_scenes.annotations.job import AnnotationJob
from blender_scenes.blender_side.loading import load_bpy
from blender_scenes.render.frame_files import FrameFile, put_in_place
from blender_scenes.render.job import RenderJob
from blender_scenes.render.protocol import (
    MESSAGE,
    REQUEST,
    Alive,
    Failed,
    Finished,
    FrameBegun,
    FrameDone,
    Message,
    Ready,
    Request,
)
from sensors.camera.response import develop, encode_jpeg, median_luminance
from symolo.core.os_errors import lacking
from symolo.dataset.layout import frame_name


def main() -> int:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the renderer decides what follows
    replies = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # whatever Blender prints goes to the log
    request = REQUEST.validate_json(sys.stdin.readline())
    threading.Thread(target=_leave_with_the_renderer, args=(request.scratch_dir,), daemon=True).start()
    threading.Thread(target=_keep_saying_so, args=(replies,), daemon=True).start()
    cv2.setNumThreads(request.threads)
    try:
        load_bpy(request.threads)  # a missing system library is reported, not raised
    except ImportError as error:
        _say(replies, Failed(str(error), lacking="libraries"))
        return 1
    try:
        _WORK[request.work](request, replies)
    except LookupError as error:
        _say(replies, Failed(str(error), lacking="device"))
        raise
    except (OSError, ValueError, RuntimeError, MemoryError) as error:
        told = lacking(error)
        _say(replies, Failed(told or str(error), lacking="machine" if told else ""))
        raise
    _say(replies, Finished())
    return 0


def _render(request: Request, replies: TextIO) -> None:
    from blender_scenes.blender_side import build, engine  # noqa: PLC0415 - they import bpy

    begin = time.perf_counter()
    job = RenderJob.from_json(Path(request.job_path).read_text())
    views = {view.number: view for view in job.frames}
    build.start()
    build.build(job.scene, job.camera, Path(request.own_files) if request.own_files else None)
    engine.configure(job, request.threads, Path(request.scratch_dir))
    metered = median_luminance(engine.metered_light(job))
    pictures = engine.Pictures(job, request.threads, Path(request.scratch_dir))
    _say(replies, Ready(time.perf_counter() - begin))
    for number in request.numbers:
        begin = time.perf_counter()
        _say(replies, FrameBegun(number))
        pixels = develop(pictures.light(views[number]), job.response, metered, number)
        data = encode_jpeg(pixels, job.response.jpeg_quality)
        path = Path(request.folder) / frame_name(number)
        sha256 = put_in_place(data, path, job.camera.width_px, job.camera.height_px)
        taken_s = time.perf_counter() - begin
        _say(replies, FrameDone(FrameFile(number, path.name, sha256, len(data), taken_s, request.threads)))


def _annotate(request: Request, replies: TextIO) -> None:
    from blender_scenes.blender_side import annotate  # noqa: PLC0415 - it imports bpy

    begin = time.perf_counter()
    job = AnnotationJob.from_json(Path(request.job_path).read_text())
    views = {view.number: view for view in job.frames}
    annotate.start(job, request.threads, Path(request.scratch_dir))
    _say(replies, Ready(time.perf_counter() - begin))
    for number in request.numbers:
        _say(replies, FrameBegun(number))
        for file in annotate.annotate(job, views[number], Path(request.folder)):
            _say(replies, FrameDone(replace(file, threads=request.threads)))


_WORK = {"pictures": _render, "annotations": _annotate}


_SECONDS_BETWEEN_BEATS = 5.0
_SPEAKING = threading.Lock()


def _say(replies: TextIO, message: Message) -> None:
    with _SPEAKING:
        replies.write(MESSAGE.dump_json(message).decode() + "\n")
        replies.flush()


def _keep_saying_so(replies: TextIO) -> None:
    """Cycles lets other threads run while it renders; a process that is stopped or stuck falls silent."""
    while True:
        time.sleep(_SECONDS_BETWEEN_BEATS)
        _say(replies, Alive())


def _leave_with_the_renderer(scratch_dir: str) -> None:
    """Ends this process when the renderer is gone, even killed: its end of the pipe closes with it."""
    sys.stdin.read()
    shutil.rmtree(scratch_dir, ignore_errors=True)
    os._exit(1)


if __name__ == "__main__":
    sys.exit(main())
