"""dkp-slam as a node of ROS 2, over the Python module: colour, depth and camera_info in, pose and tf out.

    python3 dkp_slam_node.py --ros-args -r rgb/image:=/camera/color/image_raw \
        -r depth/image:=/camera/aligned_depth_to_color/image_raw -r rgb/camera_info:=/camera/color/camera_info

NOT TESTED with ROS 2, which Debian 12 does not have: only what needs no messages is.
"""

import numpy as np

import dkp_slam

# From the first camera's frame (x right, y down, z ahead) to ROS's (x ahead, y left, z up).
ROS_FROM_WORLD = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)
TYPES = {"rgb8": (np.uint8, 3), "bgr8": (np.uint8, 3), "16UC1": (np.uint16, 1), "32FC1": (np.float32, 1)}


def array_of(image):
    """A sensor_msgs/Image as an array, without a copy."""
    dtype, channels = TYPES[image.encoding]
    rows = np.frombuffer(image.data, dtype).reshape(image.height, image.step // dtype().itemsize)
    pixels = rows[:, : image.width * channels]
    return pixels.reshape(image.height, image.width, 3) if channels == 3 else pixels


def camera_of(info):
    """Of a sensor_msgs/CameraInfo; depth in millimetres, as 16UC1 has it."""
    distortion = (list(info.d) + [0.0] * 5)[:5]
    return dkp_slam.Camera(info.width, info.height, info.k[0], info.k[4], info.k[2], info.k[5],
                           distortion=distortion, depth_scale=1000.0)


def position_and_quaternion(pose):
    """Of the camera in ROS's axes: (x, y, z), (x, y, z, w)."""
    m = ROS_FROM_WORLD @ pose
    w = np.sqrt(max(0.0, 1 + np.trace(m[:3, :3]))) / 2
    if w > 1e-3:
        x, y, z = (m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]) / (4 * w)
    else:  # half a turn
        x, y, z = np.linalg.svd(m[:3, :3] - np.eye(3))[2][2]
    return m[:3, 3], (x, y, z, w)


def main():
    import message_filters
    import rclpy
    from geometry_msgs.msg import PoseStamped, TransformStamped
    from sensor_msgs.msg import CameraInfo, Image
    from tf2_ros import TransformBroadcaster

    rclpy.init()
    node = rclpy.create_node("dkp_slam")
    out, tf = node.create_publisher(PoseStamped, "~/pose", 10), TransformBroadcaster(node)
    headers, slam = {}, None

    def take(rgb, depth, info):
        nonlocal slam
        if slam is None:
            slam = dkp_slam.Slam(dkp_slam.Config(camera_of(info), realtime=True))
        t = rgb.header.stamp.sec + 1e-9 * rgb.header.stamp.nanosec
        headers[t] = rgb.header
        slam.feed(array_of(rgb), array_of(depth), t, order=rgb.encoding[:3], copy=True)

    def publish():
        for result in slam.results() if slam else []:
            header = headers.pop(result.timestamp, None)
            for late in [t for t in headers if t < result.timestamp]:
                del headers[late]  # was dropped
            if header is None or result.pose is None:
                continue
            position, quaternion = position_and_quaternion(result.pose)
            pose, moved = PoseStamped(), TransformStamped()
            pose.header.stamp, pose.header.frame_id = header.stamp, "map"
            moved.header, moved.child_frame_id = pose.header, header.frame_id
            at, turned = pose.pose.position, moved.transform.translation
            at.x, at.y, at.z = turned.x, turned.y, turned.z = map(float, position)
            for q in (pose.pose.orientation, moved.transform.rotation):
                q.x, q.y, q.z, q.w = map(float, quaternion)
            out.publish(pose)
            tf.sendTransform(moved)

    inputs = [message_filters.Subscriber(node, kind, topic) for kind, topic in
              [(Image, "rgb/image"), (Image, "depth/image"), (CameraInfo, "rgb/camera_info")]]
    message_filters.ApproximateTimeSynchronizer(inputs, 30, 0.02).registerCallback(take)
    node.create_timer(0.005, publish)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
