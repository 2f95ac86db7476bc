"""What pyproject.toml cannot say of the wheel: it holds results/, and who signs them."""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

HERE = Path(__file__).resolve().parent


class WithResults(build_py):
    """Copy what was recorded and measured beside the modules: its command needs no more."""

    def run(self) -> None:
        """Build as usual; a working copy (an editable installation) reads the folder itself."""
        super().run()
        if not self.editable_mode:
            target = Path(self.build_lib, "lizarraga2025", "recorded_results")
            shutil.rmtree(target, ignore_errors=True)
            target.mkdir(parents=True)
            for file in sorted(HERE.glob("results/*.json")):
                shutil.copy(file, target)
            shutil.copy(HERE / "pyproject.toml", target.parent)  # who signs: [tool.qbound]
            measured = HERE / "engine" / "benchmarks" / "side_by_side.json"
            if measured.is_file():
                shutil.copy(measured, target.parent)


setup(cmdclass={"build_py": WithResults})
