"""What a decoder does wrong in its child is the fault of one image, and of nothing else."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import cv2
import numpy as np
import pytest

from symolo.core.errors import EnvironmentLacking
from symolo.core.files import image_decoder
from symolo.core.files.image_decoder import (
    AS_STORED,
    COLOUR,
    LIGHT,
    DecodedImage,
    ImageDecoder,
    ImageFile,
    Undecodable,
    decode_images,
)
from symolo.dataset.pixels import decoded_contents

ROOT = Path(__file__).parents[4]
SIZE = 3, 2
FAULTY = """
import os, signal, time
import numpy as np
import symolo.core.files.image_decoder_child as child

def decode(data, flags):
    if data == b"crashes":
        os.kill(os.getpid(), signal.SIGSEGV)
    if data == b"is endless":
        while True:
            pass
    if data == b"is large":
        return bytearray(10**9)
    if data == b"is killed":
        os.kill(os.getpid(), signal.SIGKILL)
    if data == b"ends":
        os._exit(3)
    if data == b"is no image":
        return None
    if data == b"is of another size":
        return np.zeros((5, 5), np.uint8)
    if data == b"warns":
        os.write(2, b"a warning")
    if data == b"prints":
        os.write(1, b"a message")
    if data == b"is slow":
        time.sleep(1.0)
    return np.full((2, 3), len(data), np.uint8)

child.serve(decode, seconds=1, memory_bytes=200_000_000)
"""
"""A decoder that fails as the content of the file says."""


@pytest.fixture
def decoder():
    faulty = ImageDecoder(FAULTY)
    yield faulty
    faulty.close()


def file(content, size=SIZE):
    return ImageFile(content, AS_STORED, size)


def outcomes(decoder, *contents):
    """The first pixel of each image, or why there is none."""
    answers = decoder.decode([file(content) for content in contents])
    return [int(one.pixels[0, 0]) if isinstance(one, DecodedImage) else str(one) for one in answers]


@pytest.mark.parametrize("flags", [COLOUR, AS_STORED])
@pytest.mark.parametrize("kind", [".png", ".jpg"])
@pytest.mark.parametrize("shape", [(17, 31), (17, 31, 3)])
def test_an_image_is_that_of_opencv(flags, kind, shape):
    data = cv2.imencode(kind, np.random.default_rng(1).integers(0, 256, shape, np.uint8))[1].tobytes()
    (answer,) = decode_images([ImageFile(data, flags, (31, 17))])
    expected = cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    assert answer.pixels.dtype == expected.dtype
    np.testing.assert_array_equal(answer.pixels, expected)
    assert not answer.has_message


def test_types_of_the_file_are_kept():
    deep = np.arange(6, dtype=np.uint16).reshape(2, 3) * 10_000
    light = np.arange(18, dtype=np.float32).reshape(2, 3, 3)
    files = [cv2.imencode(".png", deep)[1].tobytes(), cv2.imencode(".hdr", light)[1].tobytes()]
    stored, bright = decode_images([ImageFile(files[0], AS_STORED, SIZE), ImageFile(files[1], LIGHT, SIZE)])
    np.testing.assert_array_equal(stored.pixels, deep)
    assert bright.pixels.dtype == np.float32
    np.testing.assert_allclose(bright.pixels, light, rtol=0.01, atol=0.1)


def test_a_decoder_that_crashes_is_the_fault_of_that_image_alone(decoder):
    assert outcomes(decoder, b"a", b"crashes", b"abc") == [1, "cannot be decoded: the decoder was ended by SIGSEGV", 3]
    assert outcomes(decoder, b"ab") == [2]


def test_a_decoder_that_does_not_end_is_ended(decoder):
    begin = os.times()
    assert outcomes(decoder, b"is endless", b"a") == ["cannot be decoded: the decoder was ended by SIGXCPU", 1]
    end = os.times()
    assert sum(end[2:4]) - sum(begin[2:4]) < 10, "twice a second or two, and the start of three processes"


def test_a_decoder_gets_no_more_memory_than_an_image_may_take(decoder):
    assert outcomes(decoder, b"is large", b"a") == ["needs more memory than an image may", 1]


def test_a_decoder_that_the_system_kills_is_no_fault_of_the_image(decoder):
    """As the kernel does where memory is short: the same image may be decoded another time."""
    with pytest.raises(MemoryError, match="the system ended it, as it does where memory is short"):
        outcomes(decoder, b"is killed")
    assert outcomes(decoder, b"a") == [1]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_to_all_processes_of_a_command_is_left_to_the_owner(decoder, number):
    """Were the child to end, the owner could report the image before it hears of the signal itself."""
    outcomes(decoder, b"a")
    child = decoder._child._process
    child.send_signal(number)
    assert outcomes(decoder, b"ab") == [2]
    assert decoder._child._process is child


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"ends", "the decoder was ended by exit code 3"),
        (b"is no image", "cannot be decoded"),
        (b"is of another size", "cannot be decoded"),
    ],
)
def test_what_is_no_image_of_that_size_is_refused(decoder, content, reason):
    assert [outcomes(decoder, content)[0].endswith(reason), outcomes(decoder, b"a")] == [True, [1]]


def test_what_the_decoder_prints_is_noted_and_not_printed(decoder, capfd):
    answers = decoder.decode([file(content) for content in (b"a", b"warns", b"prints", b"a")])
    assert [answer.has_message for answer in answers] == [False, True, True, False]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "reply",
    ["0, 0, 0, 0, 1 << 31, 1 << 31", "0, 0, 9, 0, 3, 2", "0, 0, 0, 255, 3, 2", "0, 0, 2, 4, 3, 2"],
)
def test_answers_that_no_decoder_gives_are_refused(reply, monkeypatch):
    """Of a decoder that a file has taken over: a huge size, an unknown type, many channels, too few pixels."""
    program = "import os; import symolo.core.files.image_decoder_child as c; os.write(1, c.READY); os.read(0, 99);"
    liar = ImageDecoder(f"{program} os.write(1, c.REPLY.pack({reply})); os.close(1); os.read(0, 1)")
    monkeypatch.setattr(image_decoder, "_LAST_SECONDS", 0.2)
    with contextlib.closing(liar):
        (answer,) = liar.decode([file(b"a")])
    assert isinstance(answer, Undecodable)
    assert "the decoder sent an invalid reply" in str(answer)


def test_a_decoder_that_cannot_start_is_no_fault_of_an_image():
    with pytest.raises(EnvironmentLacking, match=r"cannot be started: ModuleNotFoundError: .*no_such_module"):
        ImageDecoder("import no_such_module").decode([file(b"a")])
    with pytest.raises(EnvironmentLacking, match="cannot be started: exit code 7; free some memory"):
        ImageDecoder("sys.exit(7)").decode([file(b"a")])


def test_a_system_that_starts_no_process_is_no_fault_of_an_image(monkeypatch):
    def refuse(*_, **__):
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(subprocess, "Popen", refuse)
    with pytest.raises(EnvironmentLacking, match=r"cannot be started: .*Resource temporarily unavailable"):
        ImageDecoder().decode([file(b"a")])


def test_an_interrupted_image_leaves_no_answer_to_the_next_one(decoder):
    def interrupt(_number, _frame):
        raise KeyboardInterrupt

    outcomes(decoder, b"a")
    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    try:
        with pytest.raises(KeyboardInterrupt):
            outcomes(decoder, b"is slow")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert outcomes(decoder, b"ab") == [2]


def test_no_module_of_the_working_folder_is_imported(tmp_path, monkeypatch):
    for name in ("cv2", "numpy", "symolo"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('a module of a stranger')")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", ["", *sys.path])
    data = cv2.imencode(".png", np.zeros((2, 3), np.uint8))[1].tobytes()
    with contextlib.closing(ImageDecoder()) as decoder:
        (answer,) = decoder.decode([file(data)])
    assert isinstance(answer, DecodedImage)


def test_a_system_without_limits_decodes_too():
    """As Windows, which has no module `resource` and no pipes that do not wait."""
    program = "sys.platform = 'win32'; sys.modules['resource'] = None; del sys.modules['os'].set_blocking; "
    data = cv2.imencode(".png", np.full((2, 3), 9, np.uint8))[1].tobytes()
    with contextlib.closing(ImageDecoder(f"{program} {image_decoder._PROGRAM}")) as decoder:
        (answer,) = decoder.decode([file(data)])
    assert answer.pixels.tolist() == [[9, 9, 9], [9, 9, 9]]


OWNER = """
import os, signal, sys
import symolo.core.files.image_decoder as module
decoder = module.ImageDecoder(sys.argv[1])
module._shared = lambda: decoder
os.register_at_fork(after_in_child=decoder.forget)
image = module.ImageFile(b"abc", module.AS_STORED, (3, 2))
(answer,) = module.decode_images([image])
"""


def owner(program):
    """A process that has decoded an image in a child of its own, and goes on with a program."""
    return subprocess.Popen(
        [sys.executable, "-W", "error", "-c", OWNER + program, FAULTY],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )


def test_the_child_ends_when_its_owner_is_killed():
    with owner("print(decoder._child._process.pid, flush=True); signal.pause()") as process:
        child = int(process.stdout.readline())
        process.kill()
    ends = time.monotonic() + 30
    while Path(f"/proc/{child}").exists() and _state(child) != "Z":
        assert time.monotonic() < ends
        time.sleep(0.05)


def _state(process):
    with contextlib.suppress(OSError):
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    return "Z"


def test_a_copy_of_the_process_starts_a_child_of_its_own():
    """A fork, as a loader of training data makes, must not read the answers to its parent."""
    program = """
copy = os.fork()
(answer,) = module.decode_images([module.ImageFile(b"ab" if copy == 0 else b"abcd", module.AS_STORED, (3, 2))])
if copy == 0:
    decoder.close()
    os._exit(0 if answer.pixels[0, 0] == 2 else 1)
assert answer.pixels[0, 0] == 4, answer
assert os.waitstatus_to_exitcode(os.waitpid(copy, 0)[1]) == 0
decoder.close()
"""
    with owner(program) as process:
        out, error = process.communicate()
    assert (process.returncode, out, error) == (0, "", "")


def test_images_are_decoded_together_and_come_in_their_order(monkeypatch):
    batches = []

    def counted(images):
        batches.append(len(images))
        return real(images)

    real = image_decoder.decode_images
    monkeypatch.setattr("symolo.dataset.pixels.decode_images", counted)
    data = [cv2.imencode(".png", np.full((2, 3), n, np.uint8))[1].tobytes() for n in range(100)]
    contents = [*data[:50], None, b"no image", *data[50:]]
    values = [None if image is None else int(image[0, 0]) for image in decoded_contents(iter(contents))]
    assert values == [*range(50), None, None, *range(50, 100)]
    assert max(batches) > 10
    assert sum(batches) == 100


def test_an_error_of_a_file_comes_after_the_images_before_it():
    def contents():
        yield cv2.imencode(".png", np.full((2, 3), 7, np.uint8))[1].tobytes()
        raise OSError(5, "Input/output error")

    images = decoded_contents(contents())
    assert next(images)[0, 0] == 7
    with pytest.raises(OSError, match="Input/output error"):
        next(images)
