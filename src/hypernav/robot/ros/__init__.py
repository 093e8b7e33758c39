"""What ROS messages mean, whichever library read them: a bag reader or DDS."""
