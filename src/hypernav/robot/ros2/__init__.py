"""A robot on a ROS 2 network, over DDS and without ROS."""
