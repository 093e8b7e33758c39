"""The command line of transformers, with the CPU's torchvision made usable first."""

import sys

from cpu_torchvision import prepare

prepare()

from transformers.cli.transformers import main  # noqa: E402

sys.exit(main())
