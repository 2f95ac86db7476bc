"""The one step of the build that pyproject.toml cannot say: results/ goes into the wheel."""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py


class WithResults(build_py):
    """Copy the recorded results beside the modules, so that `qbound claims` needs no repository."""

    def run(self) -> None:
        """Build as usual; a working copy (an editable installation) reads the folder itself."""
        super().run()
        if not self.editable_mode:
            target = Path(self.build_lib, "lizarraga2025", "recorded_results")
            shutil.rmtree(target, ignore_errors=True)
            target.mkdir(parents=True)
            for file in sorted(Path(__file__).resolve().parent.glob("results/*.json")):
                shutil.copy(file, target)


setup(cmdclass={"build_py": WithResults})
