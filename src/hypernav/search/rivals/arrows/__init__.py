"""VLMnav, PIVOT and the points of DyNaVLM: moves drawn into the camera image, to choose from."""
