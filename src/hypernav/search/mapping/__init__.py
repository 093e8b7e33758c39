"""The top-down map from depth images, what is derived from it, and the robot's memory."""
