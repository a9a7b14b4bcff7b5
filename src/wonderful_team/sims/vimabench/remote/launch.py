"""Started by its path in another interpreter: makes this folder importable as a package of its own, and serves."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from pathlib import Path

PACKAGE = "wonderful_team_vimabench"
CANNOT_RUN = 78
"""Exit code when this interpreter cannot run the server at all, such as without numpy."""


def main() -> None:
    """Load the package that this file lies in under a name that nothing else has, and answer until the pipe closes."""
    folder = Path(__file__).resolve().parent
    # The folder of a script that is run by its path comes first in the search path; it must hide no other module.
    sys.path[:] = [entry for entry in sys.path if Path(entry or ".").resolve() != folder]
    spec = importlib.util.spec_from_file_location(
        PACKAGE, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    assert spec is not None, "a package's own __init__.py has a spec"
    assert spec.loader is not None, "a file's spec has a loader"
    module = importlib.util.module_from_spec(spec)
    sys.modules[PACKAGE] = module
    spec.loader.exec_module(module)
    try:
        serving = importlib.import_module(f"{PACKAGE}.serving")
    except (ImportError, SyntaxError, TypeError) as error:
        sys.stderr.write(f"{type(error).__name__}: {error}\n")
        sys.exit(CANNOT_RUN)
    serving.serve()


if __name__ == "__main__":
    main()
