"""Makes ``python -m hypernav`` the same as ``hypernav``."""

from hypernav.cli.main import main

if __name__ == "__main__":
    main()
