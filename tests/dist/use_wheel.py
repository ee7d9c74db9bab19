"""Install the wheel into an environment of its own and use it there: nothing else may be needed.

Run with the interpreter that the environment is to have, from the repository's root, once ``dist``
holds a wheel. Templates, studies, the report's Typst and CSS files and the C sources must be
inside it.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import tomllib
import venv
from pathlib import Path

ROOT = Path(__file__).parents[2]
SMALL = """
base = "../loader/study.toml"
[uncertainty]
points = 2
[verification]
repeats = 1
seeds = [1]
"""
EXPORTS = {"c": "c/mptune_controller.c", "st": "*.st", "json": "*.json", "toml": "*.toml"}


def main() -> None:
    """Build the environment, run the commands in an empty folder, look at what they leave."""
    (wheel,) = (ROOT / "dist").glob("*.whl")
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        venv.create(place / "env", with_pip=True)
        python = place / "env" / "bin" / "python"
        constraints = ROOT / "constraints.txt"
        run(python, "-m", "pip", "install", "-q", "-c", constraints, wheel, cwd=place)
        mptune = place / "env" / "bin" / "mptune"
        run(mptune, "new", "loader", cwd=place)
        run(mptune, "new", "lifter", "--like", "crane", cwd=place)
        study = place / "studies" / "small" / "study.toml"
        study.parent.mkdir()
        study.write_text(SMALL, encoding="utf-8")
        done = run(mptune, "run", study, cwd=place, statuses=(0, 1))
        results = place / "reports" / "small"
        for path in (place / "reports" / "small.pdf", results / "gains.toml"):
            if not path.is_file():
                sys.exit(f"{path} was not written; status {done}")
        headline = tomllib.loads((results / "gains.toml").read_text(encoding="utf-8"))
        print("gains.toml:", {key: headline[key] for key in ("margins", "closed_loop")})
        for target in EXPORTS:
            gains = str(results / "gains.toml")
            run(mptune, "export", gains, "--to", target, "--force", cwd=place)
            if not any(results.rglob(Path(EXPORTS[target]).name)):
                sys.exit(f"export --to {target} left nothing")
    print("the wheel works on its own")


def run(*command: object, cwd: Path, statuses: tuple[int, ...] = (0,)) -> int:
    """Run a command; end with its output where its status is another than one of these."""
    words = [str(word) for word in command]
    done = subprocess.run(words, cwd=cwd, capture_output=True, text=True, check=False)
    print("$", " ".join([Path(words[0]).name, *words[1:]]), "->", done.returncode)
    if done.returncode not in statuses:
        sys.exit(done.stdout + done.stderr)
    return done.returncode


if __name__ == "__main__":
    main()
