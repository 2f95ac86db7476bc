"""What pyproject.toml cannot say of the wheel: it holds results/ and names our addresses."""

import shutil
import tomllib
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

HERE = Path(__file__).resolve().parent


class WithResults(build_py):
    """Copy what was recorded and measured beside the modules: `qbound claims` needs no more."""

    def run(self) -> None:
        """Build as usual; a working copy (an editable installation) reads the folder itself."""
        super().run()
        if not self.editable_mode:
            target = Path(self.build_lib, "lizarraga2025", "recorded_results")
            shutil.rmtree(target, ignore_errors=True)
            target.mkdir(parents=True)
            for file in sorted(HERE.glob("results/*.json")):
                shutil.copy(file, target)
            measured = HERE / "benchmarks" / "side_by_side.json"
            if measured.is_file():
                shutil.copy(measured, target.parent)


def urls() -> dict[str, str]:
    """Return the addresses that are known; `importlib.metadata` finds them where qbound runs."""
    ours = tomllib.loads((HERE / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["qbound"]
    found = {"Paper": f"https://doi.org/{ours['paper']['doi']}"}
    if ours["doi"]:
        found["DOI"] = f"https://doi.org/{ours['doi']}"
    if ours["repository"]:
        found |= {"Repository": ours["repository"], "Issues": f"{ours['repository']}/issues"}
    return found


setup(cmdclass={"build_py": WithResults}, project_urls=urls())
