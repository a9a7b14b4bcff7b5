"""Started by its path in another interpreter, with a simulator's folder: makes both importable, and serves."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from pathlib import Path

PACKAGE, SIMULATOR = "wonderful_team_process", "wonderful_team_simulator"
"""Names that nothing else has there: of the package that this file lies in, and of the simulator's folder."""
CANNOT_RUN = 78
"""Exit code when this interpreter cannot run the server at all, such as without numpy."""


def main(simulator: str) -> None:
    """Answer questions with `Bench` of the folder's `bench.py` until the pipe closes."""
    folder = Path(__file__).resolve().parent
    # The folder of a script that is run by its path comes first in the search path; it must hide no other module.
    sys.path[:] = [entry for entry in sys.path if Path(entry or ".").resolve() != folder]
    for name, at in ((PACKAGE, folder), (SIMULATOR, Path(simulator).resolve())):
        _load(name, at)
    try:
        serving = importlib.import_module(f"{PACKAGE}.serving")
        bench = importlib.import_module(f"{SIMULATOR}.bench")
    except (ImportError, SyntaxError, TypeError) as error:
        sys.stderr.write(f"{type(error).__name__}: {error}\n")
        sys.exit(CANNOT_RUN)
    serving.serve(bench.Bench())


def _load(name: str, folder: Path) -> None:
    spec = importlib.util.spec_from_file_location(
        name, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    assert spec is not None, "a package's own __init__.py has a spec"
    assert spec.loader is not None, "a file's spec has a loader"
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)


if __name__ == "__main__":
    main(sys.argv[1])
