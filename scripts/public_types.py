"""Check that every type of the public namespace is known to a type checker, and say which is not.

pyright's ``--verifytypes`` looks at all modules of a package. What `hypernav` exports, with all
members and all that their signatures name, must be complete; the rest is nobody's promise.

Run: python scripts/public_types.py
"""

import json
import subprocess
import sys
from typing import Any

import hypernav


def main() -> int:
    """Print the incomplete symbols.

    Returns:
        The exit status: 0 if there are none.
    """
    command = ["pyright", "--verifytypes", "hypernav", "--ignoreexternal", "--outputjson"]
    told = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    symbols = json.loads(told)["typeCompleteness"]["symbols"]
    public = [symbol for symbol in symbols if _is_public(symbol["name"])]
    incomplete = [symbol for symbol in public if not _is_complete(symbol)]
    for symbol in incomplete:
        print(symbol["name"])
        for diagnostic in symbol["diagnostics"]:
            print("   ", diagnostic["message"].replace("\n", "\n    "))
    if missing := _ORIGINS - {symbol["name"] for symbol in public}:
        print("pyright knows nothing of", ", ".join(sorted(missing)))
        return 1
    complete = len(public) - len(incomplete)
    print(f"{complete} of {len(public)} public symbols are completely typed")
    return 1 if incomplete else 0


_ORIGINS = {f"{getattr(hypernav, name).__module__}.{name}" for name in hypernav.__all__}


def _is_public(name: str) -> bool:
    return any(name == origin or name.startswith(f"{origin}.") for origin in _ORIGINS)


def _is_complete(symbol: dict[str, Any]) -> bool:
    return symbol["isTypeKnown"] and not symbol["isTypeAmbiguous"]


if __name__ == "__main__":
    sys.exit(main())
