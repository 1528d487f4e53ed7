"""Messages of cameras on a robot that drives in a circle: raw and compressed images, and their lenses."""

import cv2
import numpy as np

from symolo.core.geometry.poses import pose_X_WR
from tests.logs.written_bags import POSE, START_NS, T_S

WIDTH, HEIGHT, COUNT, EVERY = 16, 12, 6, 10
FOCAL = 21.5, 22.25
CENTER = 7.75, 5.5
D = (0.1, -0.05, 0.001, -0.002, 0.03)
X_RC = np.array([[0, 0, 1, 0.06], [-1, 0, 0, 0.01], [0, -1, 0, 0.12], [0, 0, 0, 1.0]])
"""A camera that looks ahead: x right, y down, z forward."""
LATE_NS = 12_300_000
"""Time from a pose to the image after it."""


def scene(number):
    """A smooth image (H, W, 3), red, green, blue, which JPEG hardly changes."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    return np.stack([8 * x + 60, 10 * y + 50, np.full_like(x, 40 + 20 * number)], axis=2).astype(np.uint8)


def bayer(pixels):
    """The pattern RGGB: red in even rows and columns, blue in odd ones (sensor_msgs/image_encodings.h)."""
    mosaic = pixels[..., 1].copy()
    mosaic[0::2, 0::2], mosaic[1::2, 1::2] = pixels[0::2, 0::2, 0], pixels[1::2, 1::2, 2]
    return mosaic


ENCODINGS = {
    "rgb8": lambda pixels: pixels,
    "bgr8": lambda pixels: pixels[..., ::-1],
    "bgra8": lambda pixels: np.dstack([pixels[..., ::-1], pixels[..., 0]]),
    "mono8": lambda pixels: pixels[..., 0],
    "bayer_rggb8": bayer,
}


def encoded(pixels, ending):
    return cv2.imencode(ending, np.ascontiguousarray(pixels[..., ::-1]))[1].ravel()


class Camera:
    """Messages of a camera in the name space `/<name>`, all in one frame."""

    def __init__(self, ros, name, frame="optical"):
        self.ros, self.name, self.frame = ros, name, frame

    def raw(self, at_ns, pixels, encoding="rgb8", padding=3):
        rows = np.ascontiguousarray(ENCODINGS[encoding](pixels)).reshape(HEIGHT, -1)
        rows = np.pad(rows, ((0, 0), (0, padding)))
        fields = {"height": HEIGHT, "width": WIDTH, "encoding": encoding, "is_bigendian": 0, "step": rows.shape[1]}
        header = self.ros.header(at_ns, self.frame)
        return f"/{self.name}/image_raw", self.ros("sensor_msgs/Image", header=header, **fields, data=rows.ravel())

    def compressed(self, at_ns, data, form="jpeg"):
        header = self.ros.header(at_ns, self.frame)
        message = self.ros("sensor_msgs/CompressedImage", header=header, format=form, data=data)
        return f"/{self.name}/image_raw/compressed", message

    def info(self, at_ns, model="plumb_bob", coefficients=D):
        K = np.array([FOCAL[0], 0, CENTER[0], 0, FOCAL[1], CENTER[1], 0, 0, 1])
        P = np.array([FOCAL[0], 0, CENTER[0], 0, 0, FOCAL[1], CENTER[1], 0, 0, 0, 1, 0.0])
        matrices = {"D": np.array(coefficients), "K": K, "R": np.eye(3).ravel(), "P": P}
        if self.ros.version == 2:
            matrices = {name.lower(): values for name, values in matrices.items()}
        whole = {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False}
        message = self.ros(
            "sensor_msgs/CameraInfo",
            header=self.ros.header(at_ns, self.frame),
            height=HEIGHT,
            width=WIDTH,
            distortion_model=model,
            binning_x=0,
            binning_y=0,
            roi=self.ros("sensor_msgs/RegionOfInterest", **whole),
            **matrices,
        )
        return f"/{self.name}/camera_info", message


def messages(ros, of_image):
    """Poses, the frame `optical` of the cameras on the robot, and what `of_image` yields for each image."""
    yield START_NS, "/tf_static", ros.transform(START_NS, "base_link", "optical", X_RC)
    for number, (t_s, pose) in enumerate(zip(T_S.tolist(), POSE.tolist(), strict=True)):
        at_ns = START_NS + round(1e9 * t_s)
        yield at_ns, "/tf", ros.transform(at_ns, "odom", "base_link", pose_X_WR(*pose))
        if number % EVERY == 0:
            late_ns = at_ns + LATE_NS
            yield from ((late_ns, *one) for one in of_image(ros, late_ns, number // EVERY))


def images(ros, at_ns, number):
    """A JPEG and a PNG file, a raw image, and one in a Bayer pattern, with the lens of each camera."""
    jpeg, png, raw, mosaic = (Camera(ros, name) for name in ("jpeg", "png", "raw", "mosaic"))
    yield from (jpeg.info(at_ns), jpeg.compressed(at_ns, encoded(scene(number), ".jpg")))
    yield from (png.info(at_ns), png.compressed(at_ns, encoded(scene(number), ".png"), "rgb8; png compressed"))
    yield from (raw.info(at_ns), raw.raw(at_ns, scene(number)))
    wide = (0.01, 0.002, 0.0, 0.0)
    yield from (mosaic.info(at_ns, "equidistant", wide), mosaic.raw(at_ns, scene(number), "bayer_rggb8"))
