"""Scripts of the repository that belong to no package, as modules."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).resolve().parents[2]


def load_script(name: str) -> ModuleType:
    """A fresh copy of a script, by its path in the repository, so that a test may change it.

    What it imports from its own folder is forgotten again: it belongs to this copy.
    """
    path = ROOT / name
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    assert module.__name__ not in sys.modules
    known = set(sys.modules)
    sys.path.insert(0, str(path.parent))
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(path.parent))
        for own in set(sys.modules) - known:
            if Path(getattr(sys.modules[own], "__file__", None) or "").parent == path.parent:
                del sys.modules[own]
    return module
