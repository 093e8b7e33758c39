"""llama.cpp's server with a model: PORT MODEL MMPROJ [IMAGE_MIN_TOKENS]."""

import sys
import threading

import xllamacpp

params = xllamacpp.CommonParams()
params.port, params.hostnames = int(sys.argv[1]), ["127.0.0.1"]
params.model.path, params.mmproj.path = sys.argv[2:4]
params.n_ctx, params.n_parallel = 8192, 1
params.cpuparams.n_threads = params.cpuparams_batch.n_threads = 1
if len(sys.argv) > 4:
    params.image_min_tokens = int(sys.argv[4])
server = xllamacpp.Server(params)
threading.Event().wait()
