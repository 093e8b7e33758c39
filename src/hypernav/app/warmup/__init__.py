"""The warm-up of compiled kernels on the first run on a machine."""
