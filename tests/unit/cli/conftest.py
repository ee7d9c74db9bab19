"""The commands called as users call them, in this process."""

import pytest

from mptune.cli.main import status


@pytest.fixture
def cli(study_file, tmp_path, capsys):
    """Run a command on the boom study (or on ``study``) and return status, stdout and stderr."""

    def run(command, *arguments, study=study_file, out=None):
        folder = tmp_path / "out" if out is None else out
        line = [command, str(study), "--out", str(folder), *arguments]
        code = status(line)
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run
