import errno
import resource

import pytest

from blender_scenes.render.surroundings import require_room, without_blender_settings


def test_variables_that_change_pixels_do_not_reach_blender_and_all_others_do():
    settings = {"OCIO": "/x/config.ocio", "BLENDER_USER_CONFIG": "/x", "CYCLES_CPU_NO_AVX2": "1", "OIDN_VERBOSE": "3"}
    kept = {"PATH": "/bin", "TMPDIR": "/scratch", "MY_BLENDER_NOTES": "x", "LD_LIBRARY_PATH": "/lib"}
    assert without_blender_settings({**settings, **kept}) == kept


def test_a_file_that_does_not_fit_is_reported_with_its_cause_and_leaves_nothing(tmp_path):
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    require_room(tmp_path, 5000)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, hard))
    try:
        with pytest.raises(OSError) as caught:
            require_room(tmp_path, 5000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert caught.value.errno == errno.EFBIG
    assert list(tmp_path.iterdir()) == []
