"""Everything in its place, view after view, in one Blender."""

import subprocess
import sys

PROGRAM = """
import bpy
import numpy as np
from blender_scenes.blender_side import build
from blender_scenes.blender_side.placing import place
from sensors.camera.views import FrameView, Moment
build.start()
for name in (build.CAMERA, build.ROBOT):
    build._place(name, None)
X = tuple(tuple(row) for row in np.eye(4).tolist())
moments = tuple(Moment((0.1 * n, 0.0, 0.0), X) for n in range(5))
for n in range(3):
    place(FrameView(n, 0.0, (0.0, 0.0, 0.0), X, exposure=moments))
print("ACTIONS", len(bpy.data.actions))
"""


def test_a_view_with_an_exposure_leaves_none_of_its_motion_behind():
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    assert "ACTIONS 2" in done.stdout, done.stdout  # of the last view: camera and robot
