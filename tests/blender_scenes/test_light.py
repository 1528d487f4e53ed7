import importlib.util
import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from blender_scenes.lighting import LIGHTS
from blender_scenes.lighting.illuminance import on_the_floor
from blender_scenes.lighting.panoramas import CEILING, MEAN_COLOR
from blender_scenes.rooms.base import Top
from blender_scenes.rooms.plain import plain_room
from blender_scenes.scene.description import LightPanel
from configs.schema.appearance.lighting import DeskLampsLook, LampsLook, SkyLook, SunLook
from configs.schema.appearance.look import LookConfig
from configs.schema.appearance.paint import Paint
from configs.schema.appearance.room import FurnitureLook, RoomLook, WindowLook
from sensors.camera.colour import LUMINANCE, light_rgb, paint_rgb

LOOK = LookConfig(name="plain")


def _room(look=LOOK):
    return plain_room(look, (-1.0, -1.0), (1.0, 1.0), 1)


def test_daylight_of_6504_kelvin_is_the_white_of_srgb():
    assert light_rgb(6504) == pytest.approx((1.0, 1.0, 1.0), abs=0.01)  # IEC 61966-2-1: D65


def test_standard_illuminant_a_has_its_tabulated_chromaticity():
    r, g, b = light_rgb(2856)
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    X, Y, Z = to_xyz @ [r, g, b]
    assert pytest.approx((0.4476, 0.4074), abs=0.003) == (X / (X + Y + Z), Y / (X + Y + Z))  # CIE 15, table T.3


def test_the_locus_has_no_step_where_its_formulas_meet():
    for kelvin in (2222.0, 7000.0):  # at 4000 K daylight is a little greener than a black body
        assert light_rgb(kelvin - 0.5) == pytest.approx(light_rgb(kelvin + 0.5), abs=0.03)


def test_a_paint_returns_its_reflectance():
    for hue in (0.0, 40.0, 120.0, 215.0):
        rgb = np.array(paint_rgb(Paint(reflectance=0.3, hue_deg=hue, saturation=0.4)))
        assert rgb @ LUMINANCE == pytest.approx(0.3)


def test_a_lamp_spreads_its_flux_over_the_hemisphere():
    look = LookConfig(name="one", lamps=LampsLook(rows=1, columns=1, flux_klm=3.0, color_temperature_K=6504))
    (panel,) = LIGHTS["ceiling_lamps"](look, _room(look)).panels
    flux = np.pi * panel.width_m * panel.height_m * np.array(panel.radiance) @ LUMINANCE  # Lambertian
    assert flux == pytest.approx(3.0)
    assert np.cross(panel.right, panel.up) == pytest.approx([0, 0, -1])


def test_illuminance_below_a_small_lamp_by_the_inverse_square():
    lamp = LightPanel("lamp", (0.0, 0.0, 2.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 0.1, 0.1, (5.0, 4.0, 3.0))
    assert on_the_floor([lamp], (0.0, 0.0, 0.0)) == pytest.approx(np.array([5.0, 4.0, 3.0]) * 0.01 / 4.0)
    aside = on_the_floor([lamp], (2.0, 0.0, 0.0))  # cos^4 of 45 degrees is a quarter
    assert aside == pytest.approx(np.array([5.0, 4.0, 3.0]) * 0.01 / 4.0 / 4.0)


def test_a_lamp_lights_nothing_behind_it():
    lamp = LightPanel("lamp", (0.0, 0.0, 2.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 0.1, 0.1, (1.0, 1.0, 1.0))
    assert on_the_floor([lamp], (0.0, 0.0, 0.0)) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("side", ["east", "north", "west", "south"])
def test_the_window_shines_into_the_room_and_the_sun_comes_in_through_it(side):
    look = LookConfig(name="w", window=WindowLook(side=side), sun=SunLook(azimuth_from_window_deg=0, elevation_deg=30))
    room = _room(look)
    (panel,) = LIGHTS["daylight"](look, room).panels
    inward = np.cross(panel.right, panel.up)
    assert inward == pytest.approx(room.window.inward)
    assert inward @ np.array(panel.center) < 0
    (sun,) = LIGHTS["sun"](look, room).suns
    assert np.linalg.norm(sun.towards) == pytest.approx(1)
    assert sun.towards[2] == pytest.approx(0.5)
    assert inward @ np.array(sun.towards) == pytest.approx(-np.cos(np.radians(30)))


def test_a_light_without_power_is_left_out():
    dark = LookConfig(
        name="dark", sun=SunLook(illuminance_klx=0), lamps=LampsLook(flux_klm=0), sky=SkyLook(luminance_kcd_m2=0)
    )
    lights = [light(dark, _room(dark)) for light in LIGHTS.values()]
    assert not any(light.panels or light.suns for light in lights)
    assert sum(len(light.skies) for light in lights) == 1


def test_the_sky_has_the_luminance_that_the_look_gives_it():
    look = LookConfig(name="s", sky=SkyLook(panorama="forest", luminance_kcd_m2=2.5))
    (sky,) = LIGHTS["daylight"](look, _room(look)).skies
    assert sky.gain * (np.array([1.0518, 1.1792, 1.3717]) @ LUMINANCE) == pytest.approx(2.5)


def test_no_piece_of_sky_shines_more_than_twice_its_mean():
    look = LookConfig(name="s", sky=SkyLook(panorama="courtyard", luminance_kcd_m2=2.5))
    (sky,) = LIGHTS["daylight"](look, _room(look)).skies
    assert sky.gain * sky.ceiling == pytest.approx(2 * 2.5)


def test_a_sheer_curtain_shines_with_what_it_lets_through_of_sky_and_sun():
    """A Lambertian transmitter: luminance = transmittance (luminance behind it + illuminance / pi)."""
    window = WindowLook(covering="sheer", curtain_transmittance=0.3)
    sun = SunLook(elevation_deg=30, azimuth_from_window_deg=60, illuminance_klx=20.0, color_temperature_K=6504)
    look = LookConfig(name="c", window=window, sun=sun, sky=SkyLook(luminance_kcd_m2=4.0))
    bare = look.model_copy(update={"window": WindowLook()})
    (panel,) = LIGHTS["daylight"](look, _room(look)).panels
    (behind,) = LIGHTS["daylight"](bare, _room(bare)).panels
    on_the_pane = 20.0 * np.cos(np.radians(30)) * np.cos(np.radians(60))
    expected = 0.3 * (np.array(behind.radiance) @ LUMINANCE + on_the_pane / np.pi)
    assert np.array(panel.radiance) @ LUMINANCE == pytest.approx(expected)
    assert panel.seen
    assert not LIGHTS["sun"](look, _room(look)).suns
    assert LIGHTS["sun"](bare, _room(bare)).suns


def test_a_sun_behind_the_house_leaves_the_curtain_to_the_sky():
    sun = SunLook(azimuth_from_window_deg=150, illuminance_klx=20.0)
    look = LookConfig(name="c", window=WindowLook(covering="sheer", curtain_transmittance=0.5), sun=sun)
    without = look.model_copy(update={"sun": SunLook(illuminance_klx=0)})
    assert LIGHTS["daylight"](look, _room(look)).panels == LIGHTS["daylight"](without, _room(without)).panels


@pytest.mark.parametrize("tilt_deg", [-30.0, 0.0, 40.0])
def test_the_slats_of_blinds_hang_in_the_niche_and_lift_their_outer_edges(tilt_deg):
    look = LookConfig(name="b", window=WindowLook(side="north", covering="blinds", slat_tilt_deg=tilt_deg))
    room = _room(look)
    (mesh,) = LIGHTS["blinds"](look, room).meshes
    vertices = np.array(mesh.vertices)
    niche = vertices[:, 1] - room.high[1]  # from the wall's face outwards
    assert 0 < niche.min() < niche.max() < 0.095  # bars stand behind
    slat = vertices[:8]
    outer, inner = slat[slat[:, 1] > slat[:, 1].mean()], slat[slat[:, 1] < slat[:, 1].mean()]
    rise = outer[:, 2].mean() - inner[:, 2].mean()
    assert rise == pytest.approx(0.05 * np.sin(np.radians(tilt_deg)), abs=1e-9)
    half = 0.5 * room.window.height_m
    assert np.all(np.abs(vertices[:, 2] - room.window.center[2]) < half + 0.02)
    assert len(LIGHTS["sun"](look, room).suns) == 1


@pytest.mark.parametrize("housing", ["none", "batten", "shade"])
def test_a_lamp_hangs_as_far_down_as_set_and_its_body_above_the_floor_below_the_ceiling(housing):
    lamps = LampsLook(rows=1, columns=2, flux_klm=2.0, width_m=0.1, drop_m=0.7, housing=housing)
    look = LookConfig(name="h", lamps=lamps)
    lights = LIGHTS["ceiling_lamps"](look, _room(look))
    for panel in lights.panels:
        assert panel.center[2] == pytest.approx(2.8 - 0.7)
        flux = np.pi * panel.width_m * panel.height_m * np.array(panel.radiance) @ LUMINANCE
        assert flux == pytest.approx(2.0)
    assert len(lights.meshes) == (0 if housing == "none" else 2)
    for mesh in lights.meshes:
        heights = np.array(mesh.vertices)[:, 2]
        assert 1.9 < heights.min() < heights.max() <= 2.8 + 1e-9
    assert {s for mesh in lights.meshes for s in mesh.face_surface} == {s.name for s in lights.surfaces}


@pytest.mark.parametrize("housing", ["none", "batten", "shade"])
@pytest.mark.parametrize("columns", [1, 4])
def test_lamps_of_a_narrow_room_end_before_its_walls_and_each_other_and_give_the_same_light(housing, columns):
    lamps = LampsLook(rows=1, columns=columns, length_m=5.0, width_m=0.4, flux_klm=2.0, housing=housing)
    room = RoomLook(margin_east_m=1.3, margin_west_m=1.3, margin_north_m=1.3, margin_south_m=1.3)
    look = LookConfig(name="narrow", lamps=lamps, room=room)
    lights = LIGHTS["ceiling_lamps"](look, _room(look))
    (x0, _), (x1, _) = _room(look).low, _room(look).high
    bodies = [np.array(mesh.vertices)[:, 0] for mesh in lights.meshes]
    bodies += [p.center[0] + 0.5 * p.width_m * np.array([-1, 1]) for p in lights.panels]
    spans = sorted({(float(body.min()), float(body.max())) for body in bodies})
    assert x0 < spans[0][0]
    assert spans[-1][1] < x1
    by_lamp = len(spans) // columns  # body and panel of each lie one about the other
    outermost = [max(high for _, high in spans[i : i + by_lamp]) for i in range(0, len(spans), by_lamp)]
    assert all(high < spans[by_lamp * (i + 1)][0] for i, high in enumerate(outermost[:-1]))
    for panel in lights.panels:
        assert np.pi * panel.width_m * panel.height_m * np.array(panel.radiance) @ LUMINANCE == pytest.approx(2.0)


@pytest.mark.parametrize(("housing", "encloses"), [("batten", False), ("shade", True)])
def test_the_gloss_of_a_shade_is_followed_and_that_of_a_batten_above_its_tube_is_not(housing, encloses):
    look = LookConfig(name="lamps", lamps=LampsLook(rows=1, columns=1, drop_m=0.5, housing=housing))
    assert [surface.encloses_lamp for surface in LIGHTS["ceiling_lamps"](look, _room(look)).surfaces] == [encloses]


def test_the_gloss_of_the_hood_of_a_desk_lamp_is_followed():
    look = LookConfig(name="desk", desk_lamps=DeskLampsLook(count=1))
    room = replace(_room(look), tops=(Top((0.0, 0.0, 0.0), (1.2, 0.6), 0.74),))
    surfaces = LIGHTS["desk_lamps"](look, room).surfaces
    assert {surface.name for surface in surfaces if surface.encloses_lamp} == {"desk_lamp_hood"}


def test_a_lamp_that_is_off_is_there_and_dark():
    lamps = (LampsLook(rows=1, columns=2, flux_klm=flux, housing="batten") for flux in (0.0, 2.0))
    looks = (LookConfig(name="c", lamps=own) for own in lamps)
    off, on = (LIGHTS["ceiling_lamps"](look, _room(look)) for look in looks)
    assert (off.panels, off.meshes) == ((), on.meshes)
    assert len(on.meshes) == 2
    furniture = RoomLook(furniture=FurnitureLook(tables=2))
    looks = (LookConfig(name="d", room=furniture, desk_lamps=DeskLampsLook(count=1, flux_klm=f)) for f in (0.0, 0.5))
    off, on = (LIGHTS["desk_lamps"](look, _room(look)) for look in looks)
    assert (off.panels, off.meshes) == ((), on.meshes)
    assert len(on.meshes) == 1


def _night(tables: int, count: int, tilt_deg: float = 40.0):
    furniture = FurnitureLook(tables=tables)
    lamps = DeskLampsLook(count=count, flux_klm=0.8, color_temperature_K=6504, height_m=0.4, tilt_deg=tilt_deg)
    look = LookConfig(name="n", room=RoomLook(furniture=furniture), desk_lamps=lamps)
    return LIGHTS["desk_lamps"](look, _room(look)), _room(look)


def test_there_are_no_more_desk_lamps_than_tables():
    assert [len(_night(tables, 3)[0].panels) for tables in (0, 1, 4)] == [0, 1, 3]
    assert not _night(2, 0)[0].meshes


def test_a_desk_lamp_stands_on_its_table_and_shines_down_and_towards_the_rooms_middle():
    lights, room = _night(2, 2)
    for panel, mesh, top in zip(lights.panels, lights.meshes, room.tops, strict=True):
        axis = np.cross(panel.right, panel.up)
        assert -axis[2] == pytest.approx(np.cos(np.radians(40)))
        to_the_middle = 0.5 * np.add(room.low, room.high) - panel.center[:2]
        assert axis[:2] @ to_the_middle == pytest.approx(np.sin(np.radians(40)) * np.linalg.norm(to_the_middle))
        flux = np.pi * panel.width_m * panel.height_m * np.array(panel.radiance) @ LUMINANCE
        assert flux == pytest.approx(0.8)
        heights = np.array(mesh.vertices)[:, 2]
        assert heights.min() == pytest.approx(top.height_m)
        assert heights.max() < top.height_m + 0.55
        foot = np.array(mesh.vertices)[heights < top.height_m + 1e-6][:, :2]
        x, y, yaw = top.pose
        own = (foot - (x, y)) @ np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
        assert np.all(np.abs(own) <= 0.5 * np.array(top.size_m))


def test_a_desk_lamp_on_a_table_in_the_middle_of_the_room_shines_along_the_table():
    look = LookConfig(name="n", desk_lamps=DeskLampsLook(count=1, tilt_deg=40.0))
    bare = _room(look)
    x, y = (0.5 * (a + b) for a, b in zip(bare.low, bare.high, strict=True))
    room = replace(bare, tops=(Top((x, y, 0.7), (1.2, 0.7), 0.72),))
    (panel,) = LIGHTS["desk_lamps"](look, room).panels
    axis = np.cross(panel.right, panel.up)
    expected = [np.sin(np.radians(40)) * np.cos(0.7), np.sin(np.radians(40)) * np.sin(0.7), -np.cos(np.radians(40))]
    np.testing.assert_allclose(axis, expected, atol=1e-9)


def test_the_table_of_panoramas_holds_what_the_files_hold():
    """Read by OpenCV, which must be told before it is loaded that it may read OpenEXR."""
    spec = importlib.util.find_spec("bpy")
    assert spec is not None
    (folder,) = Path(spec.submodule_search_locations[0]).glob("*/datafiles/studiolights/world")
    program = f"""
import cv2, json, numpy as np
means = {{}}
for name in {list(MEAN_COLOR)}:
    image = cv2.imread(f"{folder}/{{name}}.exr", cv2.IMREAD_UNCHANGED)[..., 2::-1].astype(float)
    above = np.minimum(image, {CEILING})[: len(image) // 2]
    elevation = np.pi * (0.5 - (np.arange(len(above)) + 0.5) / len(image))
    means[name] = np.average(above.mean(axis=1), axis=0, weights=np.cos(elevation)).tolist()
print(json.dumps(means))
"""
    environment = {**os.environ, "OPENCV_IO_ENABLE_OPENEXR": "1"}
    call = [sys.executable, "-c", program]
    done = subprocess.run(call, capture_output=True, text=True, check=True, env=environment)
    for name, mean in json.loads(done.stdout).items():
        assert MEAN_COLOR[name] == pytest.approx(mean, rel=0.002), name
