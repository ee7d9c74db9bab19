"""What is installed is pinned: the lock holds the versions of the constraints, each with hashes."""

import re
import tomllib

_REMEDY = "run `make lock`"


def versions(text):
    return dict(re.findall(r"^([\w.-]+)==(\S+)", text, re.MULTILINE))


def plain(name):
    return re.sub(r"[-_.]+", "-", name).lower()


def test_the_lock_holds_the_versions_of_the_constraints_and_hashes_of_each(root):
    lock = (root / "requirements.lock").read_text(encoding="utf-8")
    locked = {plain(name): version for name, version in versions(lock).items()}
    constraints = (root / "constraints.txt").read_text(encoding="utf-8")
    pinned = {plain(name): version for name, version in versions(constraints).items()}
    assert pinned.items() <= locked.items(), _REMEDY
    assert "hash" not in constraints
    entries = re.split(r"\n(?=[\w.-]+==)", lock)[1:]
    assert len(entries) == len(locked)
    for entry in entries:
        assert re.search(r" \\\n    --hash=sha256:[0-9a-f]{64}", entry), entry[:80]


def test_the_lock_holds_whatever_the_project_asks_for(root):
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    asked = project["project"]["dependencies"] + project["build-system"]["requires"]
    asked += project["project"]["optional-dependencies"]["test"]
    names = {plain(re.match(r"[\w.-]+", one)[0]) for one in asked} - {"mptune"}
    lock = (root / "requirements.lock").read_text(encoding="utf-8")
    assert names <= {plain(name) for name in versions(lock)}, _REMEDY
