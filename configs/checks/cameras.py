"""Contradictions in the cameras of a scenario: lenses, further cameras, and what needs images where there are none."""

import json
from collections.abc import Iterator
from dataclasses import replace

from pydantic import ValidationError

from configs.checks.look import exposure_faults
from configs.checks.optics import optics_faults
from configs.schema.appearance.camera_look import CameraLook
from configs.schema.robot import Camera
from configs.schema.scenario import Render, Scenario, SceneSpec
from configs.validation.faults import ConfigFault
from symolo.dataset.documents.camera_specification import KIND as CAMERA
from symolo.dataset.documents.camera_specification import further_cameras, specification_of


def lens_faults(scenario: Scenario | SceneSpec) -> Iterator[ConfigFault]:
    """Yield what is wrong with the lens of the camera of data.csv, or hybrid rendering where no lens allows it."""
    camera, render = scenario.robot.camera, scenario.render
    if camera.fisheye is not None and render.method == "hybrid" and "hybrid" not in _further_methods(scenario):
        allowed, cure = "auto or full", "write auto: images through a fisheye lens are traced in full"
        against = ("robot", "camera", "fisheye")
        yield ConfigFault(
            ("render", "method"), "it makes pinhole images", "hybrid", allowed, against=against, cure=cure
        )
    for fault in optics_faults(camera, render.width_px, render.height_px):
        yield replace(fault, path=("robot", "camera", *fault.path))


def _further_methods(scenario: Scenario | SceneSpec) -> list[str]:
    """Return the methods by which the images of further cameras are rendered."""
    content = scenario.model_dump(mode="json")
    return [specification_of(content, name)["render"]["method"] for name in further_cameras(content)]


def camera_faults(scenario: Scenario | SceneSpec) -> Iterator[ConfigFault]:
    """Yield what is wrong with a further camera where it takes the place of that of data.csv."""
    content = scenario.model_dump(mode="json")
    for name in further_cameras(content):
        specification = specification_of(content, name)
        try:
            Camera.model_validate_json(json.dumps(specification["robot"]["camera"]))
            Render.model_validate_json(json.dumps(specification["render"]))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            yield ConfigFault(("robot", "sensors", name), first["msg"])
        response = CameraLook.model_validate_json(json.dumps(specification["look"]["camera"]))
        if not scenario.look.camera.manual_exposure or scenario.look.camera.exposure_time_s:
            for fault in exposure_faults(response):
                yield replace(fault, path=("robot", "sensors", name, "exposure_time_s"))


def image_faults(scenario: Scenario) -> Iterator[ConfigFault]:
    """Yield what needs images in a scenario without any."""
    if scenario.rates.camera_hz:
        return
    rate, since = ("rates", "camera_hz"), "since rates.camera_hz is 0"
    for name, sensor in scenario.robot.sensors:
        if sensor.kind == CAMERA:
            allowed, cure = f"no camera, {since}", f"set robot.sensors.{name} to null"
            yield ConfigFault(("robot", "sensors", name), allowed=allowed, against=rate, cure=cure)
    if annotations := scenario.render.annotations:
        yield ConfigFault(("render", "annotations"), got=", ".join(annotations), allowed=f"none, {since}", against=rate)
    if scenario.splits is not None and scenario.splits.by == "image":
        yield ConfigFault(("splits", "by"), got="image", allowed=f"a property of runs, {since}", against=rate)
