"""What ROS messages mean, whatever library brought them: a bag's reader or DDS."""
