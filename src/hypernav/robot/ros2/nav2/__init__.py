"""A robot that Nav2 drives: goals out, and what odometry shows of them."""
