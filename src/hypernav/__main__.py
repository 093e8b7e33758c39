"""Makes ``python -m hypernav`` the same as ``hypernav``."""

from hypernav.app.cli.main import main

if __name__ == "__main__":
    main()
