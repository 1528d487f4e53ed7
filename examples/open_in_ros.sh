#!/bin/bash
# Opens a bag of ROS 1 and the robot of its run with the tools of ROS: rosbag, rostopic, tf and RViz.
#
#   symolo release examples/stereo_scout.yaml --out scout
#   symolo export scout --format ros1 --out exported
#   symolo model examples/stereo_scout.yaml --format urdf --out model
#   examples/open_in_ros.sh exported/ros1/CW/test_1.bag model/robot.urdf seen
#
# It writes into the folder `seen`: info.txt (rosbag info), rates.txt (rostopic hz while the bag is played), messages.txt
# (one message of some topics), pose.txt (tf_echo map base_link), frames.pdf (the tree of tf) and rviz.png.
#
# It needs ROS 1. On Debian 12: apt-get install ros-core rviz python3-rosbag python3-sensor-msgs python3-nav-msgs
#   python3-tf2-msgs tf-tools tf2-tools ros-robot-state-publisher python3-pil graphviz xvfb imagemagick
# A display is not needed: RViz runs under Xvfb and draws with the processor.
set -eu

if [ $# -ne 3 ]; then
    echo "usage: $0 BAG URDF OUT" >&2
    exit 2
fi
for tool in roscore rosbag rostopic rviz Xvfb import; do
    command -v "$tool" > /dev/null || { echo "$0: $tool is missing; see the head of this file" >&2; exit 3; }
done
bag=$(realpath "$1")
urdf=$(realpath "$2")
here=$(dirname "$(realpath "$0")")
mkdir -p "$3"
cd "$3"

export PATH=/usr/bin:/bin  # the tools of ROS need the Python of the system
export ROS_MASTER_URI=http://localhost:11391 ROS_HOSTNAME=localhost ROS_LOG_DIR=$PWD/log ROS_HOME=$PWD
started=()
trap 'kill "${started[@]}" 2> /dev/null || true' EXIT

rosbag info "$bag" > info.txt
seconds=$(rosbag info -y -k duration "$bag")

roscore -p 11391 > roscore.log 2>&1 &
started+=($!)
until rostopic list > /dev/null 2>&1; do sleep 0.5; done
rosparam set /use_sim_time true
rosparam set /robot_description -t "$urdf"

# The wheels turn with /joint_states; every other frame is in the bag already.
/usr/lib/robot_state_publisher/robot_state_publisher > robot_state_publisher.log 2>&1 &
started+=($!)

# Debian has no compressed_image_transport, with which RViz shows compressed images itself.
python3 - "$bag" > images.log 2>&1 << 'PYTHON' &
import io
import sys

import rosbag
import rospy
from PIL import Image as Picture
from sensor_msgs.msg import CompressedImage, Image


def shown(topic):
    publisher = rospy.Publisher(topic.removesuffix("/compressed"), Image, queue_size=2)

    def take(message):
        picture = Picture.open(io.BytesIO(message.data)).convert("RGB")
        size = {"height": picture.height, "width": picture.width, "step": 3 * picture.width}
        publisher.publish(Image(header=message.header, encoding="rgb8", data=picture.tobytes(), **size))

    rospy.Subscriber(topic, CompressedImage, take, queue_size=2)


rospy.init_node("images")
with rosbag.Bag(sys.argv[1]) as bag:
    topics = bag.get_type_and_topic_info().topics
for topic, about in topics.items():
    if about.msg_type == "sensor_msgs/CompressedImage":
        shown(topic)
rospy.spin()
PYTHON
started+=($!)

Xvfb :91 -screen 0 1280x800x24 > xvfb.log 2>&1 &
started+=($!)
sleep 1
DISPLAY=:91 LIBGL_ALWAYS_SOFTWARE=1 QT_X11_NO_MITSHM=1 rviz -d "$here/open_in_ros.rviz" > rviz.log 2>&1 &
started+=($!)
sleep 10

# The clock goes on after the last message, so that what was shown last remains.
/usr/lib/rosbag/play --clock -k -q "$bag" > play.log 2>&1 &
started+=($!)
sleep 1
python3 /usr/lib/tf2_tools/view_frames.py > view_frames.log 2>&1 &
started+=($!)
topics=$(rosbag info -y -k topics "$bag" | sed -n 's/^- topic: //p')
: > rates.txt
for topic in /tf /camera/camera_info /sensors/imu /sensors/lidar; do
    if grep -qx "$topic" <<< "$topics"; then
        (timeout -s INT 5 rostopic hz "$topic" 2>&1 | grep average | tail -1 | sed "s|^|$topic |" >> rates.txt) &
    fi
done
(timeout 5 rostopic echo -n 1 /joint_states > messages.txt 2>&1 || true) &
(timeout 4 /usr/lib/tf/tf_echo map base_link > pose.txt 2>&1 || true) &
sleep "$(awk -v s="$seconds" 'BEGIN { print (s > 3 ? s - 2 : 1) }')"
DISPLAY=:91 import -window root rviz.png
sleep 8
cat rates.txt
tail -5 pose.txt
echo "$PWD: info.txt, rates.txt, messages.txt, pose.txt, frames.pdf, rviz.png"
