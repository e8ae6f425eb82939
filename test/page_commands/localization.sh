python - "$ROOT/bags/thesis_190_0deg" <<'PYTHON'
import sys
from pathlib import Path

import cv2
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import Image

from doormill_ros.messages.picture import picture_of
from doormill_ros.recording.bag_reader import read_bag

message = next(m for m in read_bag(Path(sys.argv[1])) if m.topic == "/camera/image_raw")
cv2.imwrite("picture.png", picture_of(deserialize_message(message.data, Image)))
PYTHON
locate --door thesis_190_0deg picture.png --json found.json --overlay found.png
test -s found.json && test -s found.png
