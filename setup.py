"""The studies go into the wheel as they stand in the repository; all else is in pyproject.toml."""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py


class BuildWithStudies(build_py):
    """Puts every study's files beside the modules."""

    def run(self):
        """Build as usual, then copy them."""
        super().run()
        if self.editable_mode:
            return  # the repository has them
        shutil.copytree("studies", Path(self.build_lib, "mptune", "studies"), dirs_exist_ok=True)


setup(cmdclass={"build_py": BuildWithStudies})
